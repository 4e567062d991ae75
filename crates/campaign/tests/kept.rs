//! Campaigns that keep a part of their run tables.

use gyradius_campaign::{Folder, Kept, Manifest, Rows, read_run};
use proptest::prelude::*;
use std::{collections::BTreeSet, fs, sync::OnceLock};

use crate::blocks::{Campaign, assert_whole, whole};
use crate::scratch::scratch;

/// What a campaign keeps: rows, and columns, if not all.
fn kept() -> impl Strategy<Value = Kept> {
    let names = vec!["x", "y", "note", "flag", "note_kind", "status", "run"];
    let some = prop::collection::btree_set(prop::sample::select(names), 0..4);
    let columns = prop::option::of(some.prop_map(|s| s.into_iter().map(str::to_owned).collect()));
    (prop::sample::select(&Rows::ALL), columns).prop_map(|(rows, columns)| Kept::new(rows, columns))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever is kept: exactly these rows and columns are in the files, the same to the bit; nobody goes on with less than all,
    /// and who begins anew by force gets all.
    #[test]
    fn what_is_kept_is_what_was_asked_for(
        seed in any::<u64>(),
        runs in 1_u64..60,
        block_runs in 1_u64..16,
        kept in kept(),
        whole_first in any::<bool>(),
    ) {
        let scratch = scratch();
        let campaign = Campaign { place: scratch.path().join("it"), seed, block_runs };
        if whole_first {
            campaign.command(runs, None, false).unwrap();
        }
        let done = campaign.keeping(runs, None, false, &kept).unwrap();
        prop_assert_eq!(done.simulated, if whole_first { 0 } else { runs });
        let manifest = Manifest::read(&campaign.place).unwrap();
        prop_assert_eq!(manifest.kept(), &kept);
        let expected = whole(seed, runs);
        let own = ["model", "run", "status", "status_kind"];
        let asked = |name: &str| kept.columns().is_none_or(|c| {
            c.iter().any(|c| c == name || name == "note_kind" && c == "note")
        });
        let mut files = BTreeSet::new();
        for row in expected.rows() {
            let block = manifest.find("cheap", row.run()).unwrap();
            let path = campaign.place.join(block.name());
            let stays = match kept.rows() {
                Rows::All => true,
                Rows::Failed => row.failure().is_some(),
                Rows::None => false,
            };
            prop_assert!(!stays || block.has_file());
            prop_assert_eq!(block.has_file(), path.exists());
            if block.has_file() {
                files.insert(path.clone());
                let read = read_run(&path, ("cheap", row.run())).unwrap();
                prop_assert_eq!(read.is_some(), stays);
                let cells = row.cells().filter(|(c, _)| own.contains(&c.name()) || asked(c.name()));
                let cells: Vec<_> = cells.map(|(c, cell)| (c.name().to_owned(), cell)).collect();
                prop_assert!(read.is_none_or(|read| read == cells));
            }
        }
        prop_assert_eq!(campaign.files(), files.into_iter().collect::<Vec<_>>());
        let failed = expected.failures().len();
        prop_assert!(!campaign.place.join(".gyradius/campaign").exists());
        let in_place = OnceLock::new();
        let contents = campaign.contents(runs, &in_place);
        let folder = Folder::prepare(&campaign.place, &contents, false).unwrap();
        let reduced = folder.reduced(&campaign.identity()).unwrap();
        prop_assert_eq!(reduced.is_none(), kept.is_all());
        if let Some(reduced) = reduced {
            prop_assert_eq!((reduced.kept(), reduced.runs()), (&kept, runs));
            prop_assert_eq!(reduced.damaged().unwrap(), Vec::<String>::new());
            if let Some(file) = campaign.files().first() {
                fs::write(file, "other").unwrap();
                prop_assert_eq!(reduced.damaged().unwrap().len(), 1);
            } else {
                prop_assert!(kept.rows() == Rows::None || failed == 0);
            }
        }
        drop(folder);
    }

    /// A study of which not all was kept is done anew by force, and then goes on as any other.
    #[test]
    fn what_was_not_kept_is_done_again_by_force(
        seed in any::<u64>(),
        runs in 1_u64..40,
        more in 0_u64..20,
        kept in kept().prop_filter("less than all", |kept| !kept.is_all()),
    ) {
        let scratch = scratch();
        let campaign = Campaign { place: scratch.path().join("it"), seed, block_runs: 8 };
        campaign.keeping(runs, None, false, &kept).unwrap();
        let done = campaign.command(runs + more, None, true).unwrap();
        prop_assert_eq!(done.simulated, runs + more);
        assert_whole(&campaign, &done, runs + more);
    }
}
