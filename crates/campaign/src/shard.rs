//! A share of a campaign's blocks, which a process of its own does.

use std::{fmt, str::FromStr};

/// Shards that a campaign may have.
const MOST: u32 = 1_000_000;

/// One of so many shares of a campaign's blocks: every so manieth block is its own.
///
/// Shards know nothing of each other but the folder that they write into. Together they do every block once.
///
/// ```
/// use gyradius_campaign::Shard;
///
/// let second: Shard = "2/3".parse()?;
/// assert_eq!((0..7).filter(|block| second.has(*block)).collect::<Vec<u64>>(), [1, 4]);
/// assert!("4/3".parse::<Shard>().is_err());
/// # Ok::<(), gyradius_campaign::ShardError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    number: u32,
    of: u32,
}

impl Shard {
    /// The share of a number, from 1, of so many.
    ///
    /// # Errors
    /// The number is not between 1 and `of`, or `of` is above a million.
    pub fn new(number: u32, of: u32) -> Result<Self, ShardError> {
        if !(1..=of).contains(&number) || of > MOST {
            return Err(ShardError { text: format!("{number}/{of}") });
        }
        Ok(Self { number, of })
    }

    /// Whether a block of a campaign, counted from 0, is its own.
    #[must_use]
    pub fn has(self, block: u64) -> bool {
        block % u64::from(self.of) == u64::from(self.number - 1)
    }

    /// As it stands in names of files.
    pub(crate) fn name(self) -> String {
        format!("{}-of-{}", self.number, self.of)
    }
}

/// Its number from 1 and how many there are, as in `2/8`.
impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let refused = || ShardError { text: text.to_owned() };
        let (number, of) = text.split_once('/').ok_or_else(refused)?;
        let digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
        let whole = |part: &str| part.parse().ok().filter(|_| digits(part)).ok_or_else(refused);
        Self::new(whole(number)?, whole(of)?).map_err(|_| refused())
    }
}

/// A text that names no shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{text:?} is no shard: it must be a number from 1, and how many shards there are, at most a million, as in 2/8"
)]
pub struct ShardError {
    text: String,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every block belongs to one shard, and the shares differ by one block at most.
        #[test]
        fn shards_share_all_blocks(of in 1..50_u32, blocks in 0..200_u64) {
            let shards: Vec<Shard> = (1..=of).map(|number| Shard::new(number, of).unwrap()).collect();
            let share = |shard: &Shard| (0..blocks).filter(|block| shard.has(*block)).count() as u64;
            let shares: Vec<u64> = shards.iter().map(share).collect();
            prop_assert_eq!(shares.iter().sum::<u64>(), blocks);
            prop_assert!(shares.iter().max().unwrap() - shares.iter().min().unwrap() <= 1);
            for shard in shards {
                prop_assert_eq!(shard.to_string().parse::<Shard>(), Ok(shard));
            }
        }
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for text in [
            "",
            "1",
            "/",
            "1/",
            "/2",
            "0/2",
            "3/2",
            "+1/2",
            "1/+2",
            " 1/2",
            "1/2/3",
            "-1/2",
            "1.0/2",
            "1/1000001",
            "99999999999/2",
        ] {
            let error = text.parse::<Shard>().unwrap_err().to_string();
            assert!(error.contains(&format!("{text:?}")), "{error}");
        }
        assert!("1000000/1000000".parse::<Shard>().is_ok());
    }
}
