//! The numbers of a figure, for those who draw it themselves.

use serde::Serialize;

/// The numbers of a panel, a row each.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Sheet {
    pub(crate) panel: String,
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<Vec<Field>>,
}

/// What stands in a row: words, or a number if there is one.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum Field {
    Words(String),
    Number(Option<f64>),
}

impl Field {
    pub(crate) fn words(text: &str) -> Self {
        Self::Words(text.to_owned())
    }

    pub(crate) fn number(number: f64) -> Self {
        Self::Number(Some(number).filter(|number| number.is_finite()))
    }
}

/// The sheets as a script of a page holds them: JSON in which nothing ends the script. Nothing if there are none.
pub(crate) fn json(sheets: &[Sheet]) -> Option<String> {
    if sheets.is_empty() {
        return None;
    }
    // Words and numbers can always be written.
    serde_json::to_string(sheets).ok().map(|json| json.replace('<', "\\u003c"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_ends_the_script() {
        let rows =
            vec![vec![Field::words("</script>"), Field::number(0.1), Field::number(f64::NAN)]];
        let sheet = Sheet { panel: "<!--".to_owned(), columns: vec!["a\"b".to_owned()], rows };
        let written = json(&[sheet]).unwrap();
        assert!(!written.contains('<'), "{written}");
        let read: serde_json::Value = serde_json::from_str(&written).unwrap();
        assert_eq!(read[0]["panel"], "<!--");
        assert_eq!(read[0]["rows"][0], serde_json::json!(["</script>", 0.1, null]));
        assert_eq!(json(&[]), None);
    }
}
