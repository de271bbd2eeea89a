//! The files in the hands of programs that are not ours: VTK, ParaView's own library, and ASE's reader of extended XYZ.
//!
//! Run where Python has the package (`pip install vtk ase`; the interpreter is named by the variable PYTHON, or is `python3`),
//! else skipped with a message.

use std::fs;
use std::process::Command;

use granulens::contact::LawKind;
use granulens::export::{contacts, frame, spheres};

use crate::{rig, run};

/// What a script prints as JSON, given a file; none where the package is not installed.
fn told(package: &str, script: &str, file: &std::path::Path) -> Option<serde_json::Value> {
    let python = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let present = Command::new(&python).args(["-c", &format!("import {package}")]).output();
    if !present.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: no Python with {package}; pip install {package}, and name it by the variable PYTHON");
        return None;
    }
    let output = Command::new(&python).arg("-c").arg(script).arg(file).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Points, lines and arrays as VTK has read them.
const VTK: &str = r#"
import json, sys, vtk
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
data = reader.GetOutput()
flat = lambda array: [array.GetTuple(i)[k] for i in range(array.GetNumberOfTuples()) for k in range(array.GetNumberOfComponents())]
arrays = lambda of: {of.GetArrayName(i): flat(of.GetArray(i)) for i in range(of.GetNumberOfArrays())}
print(json.dumps({"points": flat(data.GetPoints().GetData()), "vertices": data.GetNumberOfVerts(), "lines": data.GetNumberOfLines(),
                  "of_points": arrays(data.GetPointData()), "of_cells": arrays(data.GetCellData())}))
"#;

#[test]
fn vtk_reads_spheres_and_contacts() {
    let simulation = run(rig(LawKind::Thesis), 1e-7, 400);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("spheres.vtp");
    fs::write(&path, spheres(&simulation)).unwrap();
    let Some(read) = told("vtk", VTK, &path) else { return };
    let view = simulation.view();
    let count = simulation.rig().sample.spheres.len();
    assert_eq!(read["vertices"], count);
    let (places, velocities) = (numbers(&read["points"]), numbers(&read["of_points"]["velocity"]));
    for k in 0..count {
        assert_eq!(places[3 * k..3 * k + 2], view.position(k));
        assert_eq!(velocities[3 * k..3 * k + 2], view.velocity(k));
    }
    fs::write(&path, contacts(&simulation)).unwrap();
    let read = told("vtk", VTK, &path).unwrap();
    let forces: Vec<f64> = view.contacts().map(|contact| contact.force).collect();
    assert_eq!(read["lines"], forces.len());
    assert!(forces.len() > 50, "{} contacts", forces.len());
    assert_eq!(numbers(&read["of_cells"]["force"]), forces);
}

/// Lattice, species, places and velocities as ASE has read them. Its species are chemical elements.
const ASE: &str = r#"
import json, sys, ase.io
frames = ase.io.read(sys.argv[1], index=":", format="extxyz")
last = frames[-1]
print(json.dumps({"frames": len(frames), "species": last.get_chemical_symbols(), "places": last.positions.ravel().tolist(),
                  "periodic": last.pbc.tolist(), "cell": last.cell.lengths().tolist(), "velocities": last.arrays["velo"].ravel().tolist(),
                  "materials": last.arrays["material"].tolist()}))
"#;

#[test]
fn ase_reads_frames() {
    let start = run(rig(LawKind::Thesis), 1e-7, 1);
    let simulation = run(rig(LawKind::Thesis), 1e-7, 400);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.xyz");
    let text = frame(&start) + &frame(&simulation);
    fs::write(&path, text).unwrap();
    let Some(read) = told("ase", ASE, &path) else { return };
    assert_eq!(read["frames"], 2);
    assert_eq!(read["periodic"], serde_json::json!([true, false, false]));
    let (rig, view) = (simulation.rig(), simulation.view());
    let period = rig.periods[0].unwrap();
    assert!((numbers(&read["cell"])[0] / period - 1.0).abs() < 1e-15);
    let (places, velocities) = (numbers(&read["places"]), numbers(&read["velocities"]));
    for (k, sphere) in rig.sample.spheres.iter().enumerate() {
        assert_eq!(read["species"][k], ["Fe", "Cu"][sphere.material]);
        assert_eq!(read["materials"][k], ["stainless-440c", "brass-260"][sphere.material]);
        assert_eq!(places[3 * k..3 * k + 2], view.position(k));
        assert_eq!(velocities[3 * k..3 * k + 2], view.velocity(k));
    }
}
