//! A journal as a table: a line for each evaluation and each case it was judged by.

use granulens::score::{Measure, Needs, Scores, Unit};
use granulens::study::{Rung, Study};

/// The values of a column.
enum Column {
    Whole(Vec<i64>),
    Number(Vec<Option<f64>>),
    Text(Vec<Option<String>>),
}

/// Columns of one length, with their names.
pub struct Table(Vec<(&'static str, Column)>);

/// A line before it is cut into columns.
struct Line<'a> {
    step: f64,
    evaluation: usize,
    crystal: usize,
    case: &'a granulens::evaluate::Case,
    scores: Scores,
    judged: &'a granulens::study::Judged,
}

/// A study's evaluations at each of its steps; crystal 0 is the one as drawn.
pub fn journal(study: &Study, rungs: &[(f64, Rung)]) -> Table {
    let cases = study.cases();
    let lines: Vec<Line> = rungs
        .iter()
        .flat_map(|(step, rung)| rung.all().iter().enumerate().map(move |(k, judged)| (*step, k + 1, judged)))
        .flat_map(|(step, evaluation, judged)| {
            // Of several forces the line has the first, and scores over all of them.
            let places = cases.iter().step_by(study.forces.count()).zip(&judged.entry.impacts).enumerate();
            places.map(move |(place, (case, scores))| {
                let crystal = place / study.impacts.len();
                let mut scores = scores.clone();
                scores.add_layout(&judged.stats);
                Line { step, evaluation, crystal, case, scores, judged }
            })
        })
        .collect();
    let whole = |of: &dyn Fn(&Line) -> u64| Column::Whole(lines.iter().map(|line| of(line) as i64).collect());
    let maybe = |of: &dyn Fn(&Line) -> Option<f64>| {
        Column::Number(lines.iter().map(|line| of(line).filter(|value| value.is_finite())).collect())
    };
    let number = |of: &dyn Fn(&Line) -> f64| maybe(&|line| Some(of(line)));
    let text = |of: &dyn Fn(&Line) -> Option<String>| Column::Text(lines.iter().map(of).collect());
    let value = |measure: Measure| {
        let number = |line: &Line| line.scores.get(measure);
        match measure.unit() {
            Unit::Count => (measure.column(), whole(&|line| number(line).unwrap_or_default() as u64)),
            _ => (measure.column(), maybe(&number)),
        }
    };
    // Ledgers are not kept, and a ratio to the first has no first.
    let kept = |measure: &&Measure| {
        let ledger = measure.needs() == Needs::Records && measure.unit() == Unit::Joule;
        !ledger && !matches!(measure, Measure::ProtectedRatio | Measure::Residual)
    };
    let measures = |layout: bool| {
        let of = move |measure: &&Measure| (measure.needs() == Needs::Layout) == layout;
        Measure::ALL.iter().filter(kept).filter(of).map(|&measure| value(measure)).collect::<Vec<_>>()
    };
    let mut table = vec![
        ("step_s", number(&|line| line.step)),
        ("evaluation", whole(&|line| line.evaluation as u64)),
        ("crystal", whole(&|line| line.crystal as u64)),
        ("force_N", number(&|line| line.case.blow.pulse.force)),
        ("duration_s", number(&|line| line.case.blow.pulse.duration)),
        ("angle_rad", number(&|line| line.case.blow.angle)),
        ("x_from_m", maybe(&|line| Some(line.case.blow.place?[0]))),
        ("x_to_m", maybe(&|line| Some(line.case.blow.place?[1]))),
    ];
    table.extend(measures(false));
    table.push(("loss", number(&|line| line.judged.loss.total)));
    table.push(("miss", number(&|line| line.judged.loss.miss)));
    table.extend(measures(true));
    table.push(("stop", text(&|line| line.judged.entry.stop.clone())));
    table.push(("layout", text(&|line| Some(line.judged.entry.layout.clone()))));
    Table(table)
}

impl Column {
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

impl Table {
    /// With a header; no value where there is none.
    pub fn csv(&self) -> String {
        let Self(columns) = self;
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let lines = columns.first().map_or(0, |(_, column)| column.len());
        let line = |line: usize| columns.iter().map(|(_, column)| column.cell(line)).collect::<Vec<_>>().join(",");
        std::iter::once(names.join(",")).chain((0..lines).map(line)).map(|line| line + "\n").collect()
    }

    /// As a Parquet file, which pandas.read_parquet takes; one group of rows.
    #[cfg(feature = "parquet")]
    pub fn parquet(&self) -> Result<Vec<u8>, parquet::errors::ParquetError> {
        use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
        use parquet::file::writer::SerializedFileWriter;
        use parquet::schema::parser::parse_message_type;

        let Self(columns) = self;
        let field = |(name, column): &(&str, Column)| match column {
            Column::Whole(_) => format!("REQUIRED INT64 {name};"),
            Column::Number(_) => format!("OPTIONAL DOUBLE {name};"),
            Column::Text(_) => format!("OPTIONAL BYTE_ARRAY {name} (UTF8);"),
        };
        let fields: Vec<String> = columns.iter().map(field).collect();
        let schema = parse_message_type(&format!("message journal {{ {} }}", fields.join(" ")))?;
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, schema.into(), Default::default())?;
        let mut group = writer.next_row_group()?;
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
        writer.close()?;
        Ok(bytes)
    }
}

/// 1 where there is a value, 0 where there is none.
#[cfg(feature = "parquet")]
fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|value| i16::from(value.is_some())).collect()
}

#[cfg(all(test, feature = "parquet"))]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    use super::*;

    #[test]
    fn a_parquet_file_holds_what_was_put_into_it() {
        let table = Table(vec![
            ("count", Column::Whole(vec![1, -2, 3])),
            ("C", Column::Number(vec![Some(2.5), None, Some(0.1)])),
            ("stop", Column::Text(vec![None, Some("says, \"no\"".to_owned()), None])),
        ]);
        assert_eq!(table.csv(), "count,C,stop\n1,2.5,\n-2,,\"says, \"\"no\"\"\"\n3,0.1,\n");
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), table.parquet().unwrap()).unwrap();
        let reader = SerializedFileReader::new(file.reopen().unwrap()).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 3);
        assert_eq!([0, 1, 2].map(|k| rows[k].get_long(0).unwrap()), [1, -2, 3]);
        assert_eq!([rows[0].get_double(1).unwrap(), rows[2].get_double(1).unwrap()], [2.5, 0.1]);
        assert!(rows[1].get_double(1).is_err());
        assert_eq!(rows[1].get_string(2).unwrap(), "says, \"no\"");
    }
}
