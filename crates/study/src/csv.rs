//! Tables as CSV.

/// The rows of a table, each field quoted where it must be.
pub(crate) fn table<Row: IntoIterator<Item: AsRef<str>>>(
    rows: impl IntoIterator<Item = Row>,
) -> String {
    let mut table = ::csv::Writer::from_writer(Vec::new());
    for row in rows {
        for field in row {
            // Memory takes whatever is written.
            let _ = table.write_field(field.as_ref());
        }
        let _ = table.write_record(None::<&[u8]>);
    }
    let bytes = table.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        let row = ["payload", "1,2,3", "a \"b\"", "", "two\nlines"];
        assert_eq!(table([row]), "payload,\"1,2,3\",\"a \"\"b\"\"\",,\"two\nlines\"\n");
    }
}
