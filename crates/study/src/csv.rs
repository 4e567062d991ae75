//! Tables as CSV.

use std::borrow::Cow;

/// The rows of a table, each field quoted where it must be.
pub(crate) fn table<'a, Row>(rows: impl IntoIterator<Item = Row>) -> String
where
    Row: IntoIterator<Item = Cow<'a, str>>,
{
    let mut table = ::csv::Writer::from_writer(Vec::new());
    for row in rows {
        for field in row {
            // Memory takes whatever is written.
            let _ = table.write_field(&*field);
        }
        let _ = table.write_record(None::<&[u8]>);
    }
    let bytes = table.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A number with as many digits as read back bit for bit; nothing if there is none.
pub(crate) fn number(number: Option<f64>) -> Cow<'static, str> {
    number.map_or(Cow::Borrowed(""), |number| number.to_string().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        let row = ["payload", "1,2,3", "a \"b\"", "", "two\nlines"].map(Cow::Borrowed);
        assert_eq!(table([row]), "payload,\"1,2,3\",\"a \"\"b\"\"\",,\"two\nlines\"\n");
        assert_eq!((number(Some(-0.1)), number(None)), ("-0.1".into(), "".into()));
    }
}
