//! Tables that are written for other tools: named columns of one length, as CSV or, with the feature `parquet`, as Parquet files.

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Numbers that may be missing.
    Number(Vec<Option<f64>>),
    /// Words that may be missing.
    Text(Vec<Option<String>>),
}

/// Columns of one length, with their names.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns(pub Vec<(&'static str, Column)>);

impl Column {
    /// Of numbers that are all there.
    pub fn numbers(values: impl IntoIterator<Item = f64>) -> Self {
        Self::Number(values.into_iter().map(Some).collect())
    }

    fn len(&self) -> usize {
        match self {
            Self::Whole(values) => values.len(),
            Self::Number(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    /// A value as CSV: nothing where there is none, text in quotes where it could be mistaken.
    fn cell(&self, line: usize) -> String {
        let quoted = |text: &String| {
            if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.clone() }
        };
        match self {
            Self::Whole(values) => values[line].to_string(),
            Self::Number(values) => values[line].map_or_else(String::new, |value| value.to_string()),
            Self::Text(values) => values[line].as_ref().map_or_else(String::new, quoted),
        }
    }
}

impl Columns {
    /// As CSV with a header; no value where there is none.
    pub fn csv(&self) -> String {
        let Self(columns) = self;
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let lines = columns.first().map_or(0, |(_, column)| column.len());
        let line = |line: usize| columns.iter().map(|(_, column)| column.cell(line)).collect::<Vec<_>>().join(",");
        std::iter::once(names.join(",")).chain((0..lines).map(line)).map(|line| line + "\n").collect()
    }
}

#[cfg(feature = "parquet")]
mod file {
    use std::io::Write;

    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
    use parquet::errors::ParquetError;
    use parquet::file::metadata::KeyValue;
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;

    use super::{Column, Columns};

    /// A Parquet file on its way, which pandas.read_parquet takes: groups of rows are written as they come, and memory holds one.
    pub struct ParquetFile<W: Write + Send>(SerializedFileWriter<W>);

    impl<W: Write + Send> ParquetFile<W> {
        /// A file for tables with the columns of `like`, none of whose rows are written yet; `notes` are its metadata.
        ///
        /// # Errors
        /// What cannot be written.
        pub fn new(to: W, name: &str, like: &Columns, notes: &[(&str, String)]) -> Result<Self, ParquetError> {
            let field = |(name, column): &(&str, Column)| match column {
                Column::Whole(_) => format!("REQUIRED INT64 {name};"),
                Column::Number(_) => format!("OPTIONAL DOUBLE {name};"),
                Column::Text(_) => format!("OPTIONAL BYTE_ARRAY {name} (UTF8);"),
            };
            let fields: Vec<String> = like.0.iter().map(field).collect();
            let schema = parse_message_type(&format!("message {name} {{ {} }}", fields.join(" ")))?;
            let notes = notes.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone())).collect();
            let properties = WriterProperties::builder().set_key_value_metadata(Some(notes)).build();
            Ok(Self(SerializedFileWriter::new(to, schema.into(), properties.into())?))
        }

        /// Rows, as a group of their own.
        ///
        /// # Errors
        /// What cannot be written.
        pub fn add(&mut self, Columns(columns): &Columns) -> Result<(), ParquetError> {
            let mut group = self.0.next_row_group()?;
            for (_, column) in columns {
                let Some(mut to) = group.next_column()? else { break };
                match column {
                    Column::Whole(values) => {
                        to.typed::<Int64Type>().write_batch(values, None, None)?;
                    }
                    Column::Number(values) => {
                        let there: Vec<f64> = values.iter().copied().flatten().collect();
                        to.typed::<DoubleType>().write_batch(&there, Some(&levels(values)), None)?;
                    }
                    Column::Text(values) => {
                        let there: Vec<ByteArray> = values.iter().flatten().map(|text| text.as_str().into()).collect();
                        to.typed::<ByteArrayType>().write_batch(&there, Some(&levels(values)), None)?;
                    }
                }
                to.close()?;
            }
            group.close()?;
            Ok(())
        }

        /// Writes what closes the file.
        ///
        /// # Errors
        /// What cannot be written.
        pub fn finish(self) -> Result<(), ParquetError> {
            self.0.close().map(|_| ())
        }
    }

    impl Columns {
        /// As a Parquet file with one group of rows.
        ///
        /// # Errors
        /// What cannot be written.
        pub fn parquet(&self, name: &str) -> Result<Vec<u8>, ParquetError> {
            let mut bytes = Vec::new();
            let mut file = ParquetFile::new(&mut bytes, name, self, &[])?;
            file.add(self)?;
            file.finish()?;
            Ok(bytes)
        }
    }

    /// 1 where there is a value, 0 where there is none.
    fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
        values.iter().map(|value| i16::from(value.is_some())).collect()
    }
}

#[cfg(feature = "parquet")]
pub use file::ParquetFile;

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Columns {
        Columns(vec![
            ("count", Column::Whole(vec![1, -2, 3])),
            ("C", Column::Number(vec![Some(2.5), None, Some(0.1)])),
            ("stop", Column::Text(vec![None, Some("says, \"no\"".to_owned()), None])),
        ])
    }

    #[test]
    fn csv_holds_what_was_put_into_it() {
        assert_eq!(table().csv(), "count,C,stop\n1,2.5,\n-2,,\"says, \"\"no\"\"\"\n3,0.1,\n");
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn a_parquet_file_holds_what_was_put_into_it() {
        use parquet::file::reader::{FileReader, SerializedFileReader};
        use parquet::record::RowAccessor;

        let file = tempfile::NamedTempFile::new().unwrap();
        let mut made =
            ParquetFile::new(file.reopen().unwrap(), "table", &table(), &[("units", "s".to_owned())]).unwrap();
        made.add(&table()).unwrap();
        made.add(&table()).unwrap();
        made.finish().unwrap();
        let reader = SerializedFileReader::new(file.reopen().unwrap()).unwrap();
        assert_eq!(reader.num_row_groups(), 2);
        let notes = reader.metadata().file_metadata().key_value_metadata().unwrap();
        assert!(notes.iter().any(|note| note.key == "units" && note.value.as_deref() == Some("s")));
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 6);
        for rows in rows.chunks(3) {
            assert_eq!([0, 1, 2].map(|k| rows[k].get_long(0).unwrap()), [1, -2, 3]);
            assert_eq!([rows[0].get_double(1).unwrap(), rows[2].get_double(1).unwrap()], [2.5, 0.1]);
            assert!(rows[1].get_double(1).is_err());
            assert_eq!(rows[1].get_string(2).unwrap(), "says, \"no\"");
        }
    }
}
