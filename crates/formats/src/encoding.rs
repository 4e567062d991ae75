//! Encodings of one byte a character: those that XML files declare, and that of tables.

/// An encoding of one byte a character that extends ASCII.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encoding(&'static encoding_rs::Encoding);

impl Encoding {
    /// That of tables, which declare none: what spreadsheets write in the west, and in it Latin-1.
    pub(crate) const OF_TABLES: Self = Self(encoding_rs::WINDOWS_1252);

    /// The encoding that an XML declaration at the beginning names, if it is one of these. Names are taken as browsers take them:
    /// what is called ASCII or ISO 8859-1 has the characters of Windows between.
    pub(crate) fn declared(body: &[u8]) -> Option<Self> {
        let head = String::from_utf8_lossy(&body[..body.len().min(200)]).to_ascii_lowercase();
        let (declaration, _) = head.strip_prefix("<?xml")?.split_once("?>")?;
        let (_, after) = declaration.split_once("encoding")?;
        let after = after.trim_start().strip_prefix('=')?.trim_start();
        let quote = after.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
        let name = after[1..].split(quote).next()?.replace('_', "-");
        let known = [name.as_str(), &name.replacen("iso8859-", "iso-8859-", 1)]
            .into_iter()
            .find_map(|name| encoding_rs::Encoding::for_label(name.as_bytes()))?;
        known.is_single_byte().then_some(Self(known))
    }

    /// The text of bytes, with a character for each of them; that of a byte that has none is U+FFFD.
    pub(crate) fn decode(self, bytes: &[u8]) -> String {
        self.0.decode_without_bom_handling(bytes).0.into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All names that browsers know.
    #[test]
    fn every_byte_has_a_character_and_ascii_stays() {
        let ascii: Vec<u8> = (0..128).collect();
        let names = (1..=16).map(|i| format!("iso-8859-{i}"));
        let names = names.chain((1250..=1258).map(|i| format!("windows-{i}")));
        let mut known = 0;
        for name in names.chain(["koi8-r", "macintosh", "ibm866"].map(str::to_owned)) {
            let declaration = format!("<?xml version='1.0' encoding='{name}'?>");
            let Some(encoding) = Encoding::declared(declaration.as_bytes()) else { continue };
            known += 1;
            assert_eq!(encoding.decode(&ascii).as_bytes(), ascii, "{name}");
            let all: Vec<u8> = (0..=255).collect();
            assert_eq!(encoding.decode(&all).chars().count(), 256, "{name}");
            assert!(all.iter().all(|byte| encoding.decode(&[*byte]).chars().count() == 1));
        }
        assert_eq!(known, 27);
    }

    #[test]
    fn declarations_name_encodings() {
        let read = |declaration: &str, byte: u8| {
            let found = Encoding::declared(declaration.as_bytes());
            found.map(|encoding| encoding.decode(&[byte]))
        };
        for (declaration, byte, expected) in [
            ("<?xml version='1.0' encoding='ISO-8859-1'?>", 0xE4, "ä"),
            ("<?xml version=\"1.0\" encoding = \"Windows-1251\" standalone='no'?>", 0xCB, "Л"),
            ("<?xml encoding='iso8859_5'?>", 0xBB, "Л"),
            ("<?xml encoding='latin1'?>", 0xFC, "ü"),
            ("<?xml encoding='US-ASCII'?>", 0x80, "€"),
            ("<?xml encoding='iso-8859-15'?>", 0xA4, "€"),
            ("<?xml encoding='iso-8859-7'?>", 0xAE, "\u{fffd}"),
        ] {
            assert_eq!(read(declaration, byte).as_deref(), Some(expected), "{declaration}");
        }
        for declaration in [
            "",
            "<robot/>",
            "<?xml?>",
            "<?xml encoding?>",
            "<?xml encoding=?>",
            "<?xml encoding='?>",
            "<?xml encoding='utf-8'?>",
            "<?xml encoding='shift-jis'?>",
            "<?xml encoding='iso-8859-12'?>",
            "<?xml encoding=ä?>",
        ] {
            assert!(read(declaration, 0xE4).is_none(), "{declaration}");
        }
    }
}
