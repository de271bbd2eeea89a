"""The package: how fast it comes, how large it is, what it says of itself."""

import os
import subprocess
import sys
from pathlib import Path

import granulens as gl

from conftest import REPOSITORY, call

# Time of the processor, since that of the wall is also what else the machine does; of several the best, with its caches warm.
TIMED = """
import sys, time
begun = time.process_time()
import granulens
spent = time.process_time() - begun
assert "numpy" not in sys.modules, "numpy is imported by those who make arrays"
print(spent)
"""


def test_import_takes_less_than_50_ms():
    times = [float(subprocess.check_output([sys.executable, "-c", TIMED])) for _ in range(7)]
    assert min(times) < 0.05, times


def test_wheel_is_below_6_MB():
    package = Path(gl.__file__).parent
    wheel = os.environ.get("GRANULENS_WHEEL")
    # Without the wheel at hand: its one large file, as it would be packed.
    size = Path(wheel).stat().st_size if wheel else packed(next(package.glob("_granulens*.so")))
    assert size < 6e6, size


def packed(path: Path) -> int:
    import zlib

    return len(zlib.compress(path.read_bytes(), 6))


def test_version_is_that_of_the_program():
    said = call("--version").stdout
    assert gl.__version__ in said


def test_everything_public_says_what_it_is():
    for name in gl.__all__:
        thing = getattr(gl, name)
        if callable(thing):
            assert thing.__doc__, name
            for attribute in vars(thing) if isinstance(thing, type) else ():
                member = getattr(thing, attribute)
                if not attribute.startswith("_") and callable(member):
                    assert member.__doc__, f"{name}.{attribute}"


def test_stubs_are_those_of_the_module(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "granulens._granulens", "--mypy-config-file", str(REPOSITORY / "python/pyproject.toml")],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stdout + done.stderr
