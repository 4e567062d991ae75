//! What TOML and JSON files hold: the few kinds of values that they share, and where each stands.

use std::borrow::Cow;

use crate::{
    FileBodyError,
    body::{Number, Place, shortened},
};

#[derive(Debug)]
pub(crate) struct Item<'a> {
    pub(crate) start: usize,
    pub(crate) value: Value<'a>,
}

#[derive(Debug)]
pub(crate) enum Value<'a> {
    /// As it is written, and its end.
    Number(Cow<'a, str>, usize),
    Text(String),
    List(Vec<Item<'a>>),
    Table(Vec<(String, Item<'a>)>),
    Other,
}

impl<'a> Item<'a> {
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        self.entries().iter().find(|(name, _)| name == key).map(|(_, item)| item)
    }

    pub(crate) fn entries(&self) -> &[(String, Self)] {
        match &self.value {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    pub(crate) fn items(&self) -> &[Self] {
        match &self.value {
            Value::List(items) => items,
            _ => &[],
        }
    }

    pub(crate) fn number(&self, field: &'static str) -> Result<Number, FileBodyError> {
        match &self.value {
            Value::Number(raw, end) => {
                let number = Number::parse(field, raw, Some(self.start))?;
                let place = number.place.map(|place| Place { end: *end, ..place });
                Ok(Number { place, ..number })
            }
            Value::Text(text) => Err(FileBodyError::NotANumber { field, value: shortened(text) }),
            _ => Err(FileBodyError::Shape { field, allowed: "a number" }),
        }
    }
}
