#!/usr/bin/env bash
# The letters of pictures as PNG: Liberation Sans 2 (SIL Open Font License 1.1) cut down to those that pictures hold. The licence reserves
# the name Liberation for what is not changed, so the parts are called Granulens Sans. Needs fonttools (Python).
#   bash src/report/paper/fonts/make.sh FOLDER_OF_LIBERATION_TTF
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
letters='U+0020-007E,U+00A0-00FF,U+0391-03A9,U+03B1-03C9,U+2013,U+2014,U+2018,U+2019,U+2026,U+2212,U+2264,U+2265,U+221A,U+2080-2089'
for face in Regular Bold; do
  name=$(echo "sans-$face.ttf" | tr '[:upper:]' '[:lower:]')
  pyftsubset "$1/LiberationSans-$face.ttf" --unicodes="$letters" --no-hinting --layout-features='' --name-IDs='0,1,2,13,14' --notdef-outline --output-file="$here/$name"
  python3 - "$here/$name" "$face" <<'PY'
import sys
from fontTools.ttLib import TTFont
font = TTFont(sys.argv[1])
for record in font["name"].names:
    if record.nameID == 1:
        record.string = "Granulens Sans"
    if record.nameID == 2:
        record.string = sys.argv[2]
font.save(sys.argv[1])
PY
done
