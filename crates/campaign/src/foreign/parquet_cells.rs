//! The cells of a column of a Parquet file, whatever its type: numbers, or texts as they would stand in CSV.

use parquet::{
    basic::{ConvertedType, LogicalType, Type as Physical},
    column::reader::ColumnReader,
    errors::ParquetError,
    schema::types::ColumnDescriptor,
};

use super::written::number;
use crate::stored::read;

/// The cells of some consecutive rows; none where nothing stands.
#[derive(Debug)]
pub(super) enum Cells {
    Numbers(Vec<Option<f64>>),
    /// What is no number by its type. Dates and times begin with no letter, as in CSV.
    Texts(Vec<Option<String>>),
}

impl Cells {
    pub(super) fn read(
        reader: ColumnReader,
        column: &ColumnDescriptor,
        rows: usize,
    ) -> Result<Self, ParquetError> {
        macro_rules! cells {
            ($as:ident, $reader:expr, $cell:expr) => {
                Self::$as(read($reader, rows)?.into_iter().map(|cell| cell.map($cell)).collect())
            };
        }
        use ColumnReader as R;
        Ok(match (reader, Meaning::of(column)) {
            (R::BoolColumnReader(r), _) => cells!(Numbers, r, |flag| f64::from(u8::from(flag))),
            (R::FloatColumnReader(r), _) => cells!(Numbers, r, f64::from),
            (R::DoubleColumnReader(r), _) => cells!(Numbers, r, |number| number),
            (R::Int32ColumnReader(r), Meaning::Signed) => cells!(Numbers, r, f64::from),
            (R::Int64ColumnReader(r), Meaning::Signed) => cells!(Numbers, r, |whole| whole as f64),
            (R::Int32ColumnReader(r), Meaning::Unsigned) => {
                cells!(Numbers, r, |whole| f64::from(whole.cast_unsigned()))
            }
            (R::Int64ColumnReader(r), Meaning::Unsigned) => {
                cells!(Numbers, r, |whole| whole.cast_unsigned() as f64)
            }
            (R::Int32ColumnReader(r), Meaning::Decimal { scale }) => {
                cells!(Numbers, r, |digits| decimal(digits.into(), scale))
            }
            (R::Int64ColumnReader(r), Meaning::Decimal { scale }) => {
                cells!(Numbers, r, |digits| decimal(digits.into(), scale))
            }
            (R::ByteArrayColumnReader(r), Meaning::Decimal { scale }) => {
                cells!(Numbers, r, |digits| long_decimal(digits.data(), scale))
            }
            (R::FixedLenByteArrayColumnReader(r), Meaning::Decimal { scale }) => {
                cells!(Numbers, r, |digits| long_decimal(digits.data(), scale))
            }
            (R::FixedLenByteArrayColumnReader(r), Meaning::Half) => {
                cells!(Numbers, r, |bytes| half(bytes.data()))
            }
            (R::Int32ColumnReader(r), Meaning::Half | Meaning::Other) => {
                cells!(Texts, r, |time| format!("{time} (date or time)"))
            }
            (R::Int64ColumnReader(r), Meaning::Half | Meaning::Other) => {
                cells!(Texts, r, |time| format!("{time} (date or time)"))
            }
            (R::Int96ColumnReader(r), _) => {
                cells!(Texts, r, |time| format!("{:?} (date or time)", time.data()))
            }
            (
                R::ByteArrayColumnReader(r),
                Meaning::Signed | Meaning::Unsigned | Meaning::Half | Meaning::Other,
            ) => cells!(Texts, r, |bytes| text(bytes.data())),
            (
                R::FixedLenByteArrayColumnReader(r),
                Meaning::Signed | Meaning::Unsigned | Meaning::Other,
            ) => cells!(Texts, r, |bytes| text(bytes.data())),
        })
    }

    /// The texts of the cells, of whole numbers with all digits.
    pub(super) fn read_texts(
        reader: ColumnReader,
        column: &ColumnDescriptor,
        rows: usize,
    ) -> Result<Vec<Option<String>>, ParquetError> {
        match (reader, Meaning::of(column)) {
            (ColumnReader::Int64ColumnReader(r), Meaning::Signed) => {
                let cells = read(r, rows)?.into_iter();
                Ok(cells.map(|cell| cell.map(|whole| whole.to_string())).collect())
            }
            (ColumnReader::Int64ColumnReader(r), Meaning::Unsigned) => {
                let cells = read(r, rows)?.into_iter();
                Ok(cells.map(|cell| cell.map(|x| x.cast_unsigned().to_string())).collect())
            }
            (reader, _) => Ok(Self::read(reader, column, rows)?.texts()),
        }
    }

    /// The numbers; none where a text is none.
    pub(super) fn numbers(self) -> Vec<Option<f64>> {
        match self {
            Self::Numbers(numbers) => numbers,
            Self::Texts(texts) => {
                texts.iter().map(|cell| number(cell.as_deref()?).flatten()).collect()
            }
        }
    }

    /// The texts: of numbers what they are.
    pub(super) fn texts(self) -> Vec<Option<String>> {
        match self {
            Self::Numbers(numbers) => {
                let numbers = numbers.into_iter().map(|cell| cell.filter(|x| !x.is_nan()));
                numbers.map(|cell| cell.map(|number| number.to_string())).collect()
            }
            Self::Texts(texts) => texts,
        }
    }
}

/// Whether a column is of numbers of 32 or 64 bits, whole numbers or flags.
pub(super) fn has_numbers(column: &ColumnDescriptor) -> bool {
    match column.physical_type() {
        Physical::BOOLEAN
        | Physical::INT32
        | Physical::INT64
        | Physical::FLOAT
        | Physical::DOUBLE => match Meaning::of(column) {
            Meaning::Signed | Meaning::Unsigned => true,
            Meaning::Decimal { .. } | Meaning::Half | Meaning::Other => false,
        },
        Physical::INT96 | Physical::BYTE_ARRAY | Physical::FIXED_LEN_BYTE_ARRAY => false,
    }
}

/// What the bits of a cell mean.
#[derive(Clone, Copy)]
enum Meaning {
    /// What they are, whole numbers with a sign.
    Signed,
    /// What they are, whole numbers without a sign.
    Unsigned,
    /// So many decimals of a whole number stand behind the point.
    Decimal { scale: i32 },
    /// A number of 16 bits.
    Half,
    /// A text, a date, a time, or anything else.
    Other,
}

impl Meaning {
    /// The older of the two ways to say what a number means stands alone in the files of some writers, DuckDB's among them.
    fn of(column: &ColumnDescriptor) -> Self {
        match column.logical_type_ref() {
            Some(LogicalType::Integer(whole)) if whole.is_signed => return Self::Signed,
            Some(LogicalType::Integer(_)) => return Self::Unsigned,
            Some(LogicalType::Decimal(_)) => return Self::Decimal { scale: column.type_scale() },
            Some(LogicalType::Float16) => return Self::Half,
            Some(_) => return Self::Other,
            None => {}
        }
        match column.converted_type() {
            ConvertedType::NONE
            | ConvertedType::INT_8
            | ConvertedType::INT_16
            | ConvertedType::INT_32
            | ConvertedType::INT_64 => Self::Signed,
            ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64 => Self::Unsigned,
            ConvertedType::DECIMAL => Self::Decimal { scale: column.type_scale() },
            ConvertedType::UTF8
            | ConvertedType::MAP
            | ConvertedType::MAP_KEY_VALUE
            | ConvertedType::LIST
            | ConvertedType::ENUM
            | ConvertedType::DATE
            | ConvertedType::TIME_MILLIS
            | ConvertedType::TIME_MICROS
            | ConvertedType::TIMESTAMP_MILLIS
            | ConvertedType::TIMESTAMP_MICROS
            | ConvertedType::JSON
            | ConvertedType::BSON
            | ConvertedType::INTERVAL => Self::Other,
        }
    }
}

/// A text without the blanks around it, as CSV is read; of bytes that are none, each as it is escaped, so that those of two models differ.
fn text(bytes: &[u8]) -> String {
    let text = std::str::from_utf8(bytes).map(str::to_owned);
    let text = text.unwrap_or_else(|_| bytes.escape_ascii().to_string());
    text.trim_end_matches('\0').trim().to_owned()
}

/// The number that its digits are, rounded once.
fn decimal(digits: i128, scale: i32) -> f64 {
    format!("{digits}e{}", -i64::from(scale)).parse().unwrap_or(f64::NAN)
}

/// The same of digits in two's complement, the highest byte first; NaN beyond 128 bits.
fn long_decimal(bytes: &[u8], scale: i32) -> f64 {
    let is_negative = bytes.first().is_some_and(|byte| *byte >= 0x80);
    let start = Some(if is_negative { -1 } else { 0_i128 });
    let digits = bytes
        .iter()
        .fold(start, |digits, byte| digits?.checked_mul(256)?.checked_add(i128::from(*byte)));
    digits.map_or(f64::NAN, |digits| decimal(digits, scale))
}

/// The number that two bytes are, the lower one first (IEEE 754, binary16).
fn half(bytes: &[u8]) -> f64 {
    let Ok(bytes) = bytes.try_into() else { return f64::NAN };
    let bits = u16::from_le_bytes(bytes);
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    let size = match exponent {
        0 => libm::ldexp(fraction, -24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => libm::ldexp(1024.0 + fraction, exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A decimal number is the one that its text is, in as many bytes as it takes or more.
        #[test]
        fn decimals_are_what_their_texts_are(digits: i128, shift in 0..127_u32, scale in 0..38_i32, more in 0..20_usize) {
            let digits = digits >> shift;
            let text = format!("{:0>40}", digits.unsigned_abs());
            let (whole, fraction) = text.split_at(text.len() - scale as usize);
            let sign = if digits < 0 { "-" } else { "" };
            let expected: f64 = format!("{sign}{whole}.{fraction}").parse().unwrap();
            prop_assert_eq!(decimal(digits, scale), expected);
            let fill = if digits < 0 { 0xff } else { 0 };
            let mut bytes = digits.to_be_bytes().to_vec();
            while bytes.len() > 1 && bytes[0] == fill && (bytes[1] >= 0x80) == (fill == 0xff) {
                bytes.remove(0);
            }
            bytes.splice(0..0, vec![fill; more]);
            prop_assert_eq!(long_decimal(&bytes, scale), expected);
        }

        #[test]
        fn whole_numbers_of_16_bits_are_exact(whole in -2048..=2048_i32, halvings in 0..14_i32) {
            let number = f64::from(whole) / f64::from(1 << halvings);
            let bits = (number as f32).to_bits();
            let exponent = if whole == 0 { 0 } else { ((bits >> 23 & 255) + 15 - 127) << 10 };
            let bits = (bits >> 16 & 0x8000 | exponent | bits >> 13 & 1023) as u16;
            prop_assert_eq!(half(&bits.to_le_bytes()), number);
        }
    }

    #[test]
    fn numbers_of_16_bits_reach_their_ends() {
        for (bits, number) in
            [(1_u16, 5.960_464_477_539_063e-8), (0x7bff, 65504.0), (0xfc00, f64::NEG_INFINITY)]
        {
            assert_eq!(half(&bits.to_le_bytes()), number);
        }
        assert!(half(&0x7e00_u16.to_le_bytes()).is_nan() && half(&[0]).is_nan());
        // Beyond what can be told.
        assert!(long_decimal(&[0x7f; 17], 0).is_nan());
    }
}
