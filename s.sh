for m in 440c brass al; do for l in hertz consistent thesis linear; do for v in 0.05 1 20; do
cat > sweep.toml <<T
format = 1
kind = "rig"
name = "sweep"
[crystal]
packing = "chain"
diameter = "20 mm"
layers = 2
material = "$m"
[law]
kind = "$l"
[[moving]]
layers = 1
velocity = "$v m/s"
[[moving]]
layers = 2
velocity = "-$v m/s"
[run]
window = "400 us"
T
rm -rf sweep; $1 simulate sweep.toml --threads 1 -q --out sweep > /dev/null 2>&1 || echo "stopped: $m $l $v m/s"; awk -F, 'NR>1{r=$NF<0?-$NF:$NF; if(r>m)m=r} END{print m}' sweep/energies.csv | tr '\n' ' '; rm -rf sweep; done; done; done
