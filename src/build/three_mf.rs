//! A solid as 3MF, the file of slicers: an archive that holds an XML of corners and triangles, with its unit.
//!
//! 3MF Core Specification 1.3 (3MF Consortium): the content types, the relation that names the model, and the model. Entries are not
//! compressed, so that the same solid gives the same bytes whichever library packs them.

use std::fmt::Write as _;
use std::io::{self, Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::frame::Solid;
use crate::report::escape;

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// The model: every corner once, and triangles by the numbers of their corners.
fn model(solid: &Solid, title: &str) -> String {
    let mut corners: Vec<[f64; 3]> = Vec::new();
    let mut place = |corner: &[f64; 3]| {
        corners.iter().position(|known| known == corner).unwrap_or_else(|| {
            corners.push(*corner);
            corners.len() - 1
        })
    };
    let triangles: Vec<[usize; 3]> = solid.triangles.iter().map(|[a, b, c]| [place(a), place(b), place(c)]).collect();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<metadata name=\"Title\">{}</metadata>\n\
         <resources><object id=\"1\" type=\"model\"><mesh>\n<vertices>\n",
        escape(title)
    );
    for [x, y, z] in corners {
        let _ = writeln!(text, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
    }
    text += "</vertices>\n<triangles>\n";
    for [a, b, c] in triangles {
        let _ = writeln!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
    }
    text + "</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n"
}

impl Solid {
    /// As 3MF, in millimetres.
    ///
    /// # Errors
    /// What the archive says; none is known that memory would give.
    pub fn three_mf(&self, title: &str) -> io::Result<Vec<u8>> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default());
        for (name, text) in
            [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS), ("3D/3dmodel.model", &model(self, title))]
        {
            archive.start_file(name, options)?;
            archive.write_all(text.as_bytes())?;
        }
        Ok(archive.finish()?.into_inner())
    }
}
