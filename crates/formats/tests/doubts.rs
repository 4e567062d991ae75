//! What a simulator makes of a file beside its links: elements that make several bodies of one.

use gyradius_formats::{CompilerDoubt, RobotFile};
use proptest::{prelude::*, sample::select};
use std::path::Path;

fn doubts(name: &str, text: &str) -> Vec<CompilerDoubt> {
    let robot = RobotFile::parse(Path::new(name), text.as_bytes().to_vec()).unwrap();
    robot.compiler_doubts().to_vec()
}

/// A body or a frame of an MJCF file, and what stands in it.
#[derive(Clone, Debug)]
struct Part {
    is_body: bool,
    /// Names are given to each by its place, so that all differ.
    is_named: bool,
    inside: Vec<Part>,
}

fn part() -> impl Strategy<Value = Part> {
    let leaf = any::<[bool; 2]>().prop_map(|[is_body, is_named]| Part {
        is_body,
        is_named,
        inside: Vec::new(),
    });
    leaf.prop_recursive(4, 12, 3, |inner| {
        (any::<[bool; 2]>(), prop::collection::vec(inner, 0..3))
            .prop_map(|([is_body, is_named], inside)| Part { is_body, is_named, inside })
    })
}

/// The text of parts, and of each its name, whether it is a body, and the first body in it.
fn written(
    parts: &[Part],
    all: &mut Vec<(Option<String>, bool, Option<String>)>,
) -> (String, Option<String>) {
    let (mut text, mut first) = (String::new(), None);
    for part in parts {
        let place = all.len();
        let name = part.is_named.then(|| format!("n{place}"));
        all.push((name.clone(), part.is_body, None));
        let (inside, of_inside) = written(&part.inside, all);
        all[place].2.clone_from(&of_inside);
        let named = name.as_ref().map_or(String::new(), |name| format!(" name='{name}'"));
        let (element, own) = if part.is_body {
            ("body", "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>")
        } else {
            ("frame", "")
        };
        text += &format!("<{element}{named}>{own}{inside}</{element}>");
        let of_part = if part.is_body {
            Some(name.unwrap_or_else(|| "unnamed".to_owned()))
        } else {
            of_inside
        };
        first = first.or(of_part);
    }
    (text, first)
}

/// Some of the numbers of the bias of a motor, from the first on.
fn bias() -> impl Strategy<Value = Vec<i32>> {
    let second = select(vec![0, -1, -50, -40]);
    (second, select(vec![0, -1, 1, 2]), 1..4_usize).prop_map(|(second, third, length)| {
        let mut bias = vec![0, second, third];
        bias.truncate(length);
        bias
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// MuJoCo 4.0.0 makes other bodies of those that are attached, by themselves or in a frame, and none of a frame without.
    #[test]
    fn what_is_attached_within_a_file_is_told(parts in prop::collection::vec(part(), 1..4), pick in any::<prop::sample::Index>()) {
        let mut all = Vec::new();
        let (text, _) = written(&parts, &mut all);
        let (name, is_body, inside) = pick.get(&all);
        let Some(name) = name else { return Ok(()) };
        let key = if *is_body { "body" } else { "frame" };
        let with = |more: &str| format!(
            "<mujoco><worldbody>{text}<frame pos='3 0 0'><attach {key}='{name}' prefix='p'{more}/></frame></worldbody></mujoco>"
        );
        let attached = if *is_body { Some(name.clone()) } else { inside.clone() };
        let expected: Vec<_> =
            attached.map(|body| CompilerDoubt::Attached { body }).into_iter().collect();
        prop_assert_eq!(doubts("r.xml", &with("")), expected);
        // Of another file, it is none of these.
        prop_assert_eq!(doubts("r.xml", &with(" model='m'")), []);
    }

    /// The compiler of an included file counts for all, as MuJoCo 4.0.0 shows with settotalmass, and that of another model
    /// for that model alone.
    #[test]
    fn the_compiler_of_another_model_is_its_own(model in any::<bool>(), include in any::<bool>(), is_late in any::<bool>()) {
        let model = if model { "<asset><model name='c' file='c.xml'/></asset>" } else { "" };
        let included = if include { "<include file='c.xml'/>" } else { "" };
        let body = "<worldbody><body name='a'><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody>";
        let text = if is_late { format!("{body}{model}{included}") } else { format!("{included}{model}{body}") };
        let found = doubts("r.xml", &format!("<mujoco>{text}</mujoco>"));
        prop_assert_eq!(found.contains(&CompilerDoubt::Included), include, "{:?}", found);
        prop_assert_eq!(found.len(), usize::from(include));
    }

    /// With MuJoCo 4.0.0 the damping of a motor with `dampratio`, and the stiffness and damping of a joint with `springdamper`, grow with the
    /// mass, also by a default, unless they are zero.
    #[test]
    fn damping_that_follows_the_masses_is_told(parts in prop::collection::vec((0..5_usize, select(vec!["0", "0.7", "1"])), 0..5)) {
        let mut places = ["", "", ""].map(String::from);
        let mut told = [None, None];
        for (part, value) in parts {
            let (place, text, name, value) = match part {
                0 => (0, "<default><position dampratio='?'/></default>", 0, value.to_owned()),
                1 => (0, "<default><joint springdamper='?'/></default>", 1, format!("{value} {value}")),
                2 => (1, "<joint springdamper='?'/>", 1, format!("{value}  {value}")),
                3 => (2, "<position joint='j' kp='9' dampratio='?'/>", 0, value.to_owned()),
                _ => (2, "<intvelocity joint='j' kp='9' dampratio=' ? '/>", 0, value.to_owned()),
            };
            places[place] += &text.replace('?', &value);
            if value.split_whitespace().any(|number| number != "0") {
                // The first in the file counts, and defaults stand before joints, and these before motors.
                let first: &mut Option<(usize, String)> = &mut told[name];
                if first.as_ref().is_none_or(|(other, _)| place < *other) {
                    *first = Some((place, value));
                }
            }
        }
        let [defaults, joints, motors] = places;
        let text = format!(
            "<mujoco><default>{defaults}</default><worldbody><body name='a'>{joints}<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody>\
             <actuator>{motors}</actuator></mujoco>"
        );
        let expected: Vec<_> = ["dampratio", "springdamper"].into_iter().zip(told).filter_map(|(name, told)| {
            Some(CompilerDoubt::Damped { told: format!("{name}=\"{}\"", told?.1) })
        }).collect();
        prop_assert_eq!(doubts("r.xml", &text), expected);
    }

    /// MuJoCo 4.0.0 takes the third number of a bias for a damping ratio where it is positive and the second is the gain with the opposite
    /// sign, each taken from the motor, from its default, or, for the gain, 1; the damping that it makes of it is zero where the gain is.
    #[test]
    fn a_bias_that_is_a_damping_ratio_is_told(
        of_default in prop::option::of(bias()), of_motor in prop::option::of(bias()),
        gain_of_default in prop::option::of(select(vec![0, 1, 50])), gain_of_motor in prop::option::of(select(vec![0, 1, 50])),
        is_named in any::<bool>(), is_cylinder in any::<bool>(),
    ) {
        let (element, bias_name) = if is_cylinder { ("cylinder", "bias") } else { ("general", "biasprm") };
        let gain_name = if is_cylinder { "area" } else { "gainprm" };
        let bias_text = |bias: &[i32]| bias.iter().map(i32::to_string).collect::<Vec<_>>().join(" ");
        let attributes = |bias: &Option<Vec<i32>>, gain: Option<i32>| {
            let bias = bias.as_ref().map(|bias| format!(" {bias_name}='{}'", bias_text(bias)));
            let gain = gain.map(|gain| format!(" {gain_name}='{gain}'"));
            bias.unwrap_or_default() + &gain.unwrap_or_default()
        };
        let class = if is_named { " class='c'" } else { "" };
        let default = format!("<{element}{}/>", attributes(&of_default, gain_of_default));
        let default = if is_named { format!("<default class='c'>{default}</default>") } else { default };
        let motor = attributes(&of_motor, gain_of_motor);
        let text = format!(
            "<mujoco><default>{default}</default><worldbody><body name='a'><joint name='j'/>\
             <inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody>\
             <actuator><{element}{class} joint='j'{motor}/></actuator></mujoco>"
        );
        let third = |i: usize| [&of_motor, &of_default].into_iter().flatten().find_map(|bias| bias.get(i).copied());
        let gain = gain_of_motor.or(gain_of_default).unwrap_or(1);
        let follows = third(2).is_some_and(|ratio| ratio > 0) && gain != 0 && third(1) == Some(-gain);
        let told: Vec<_> = doubts("r.xml", &text);
        if follows {
            prop_assert_eq!(told.len(), 1, "{}", text);
        }
        // Nothing is told of a file in which no bias has a third number that is positive, nor of one in which the motor says all itself
        // and takes no ratio.
        let ratio = |bias: &Option<Vec<i32>>| bias.as_ref().is_some_and(|bias| bias.get(2).is_some_and(|ratio| *ratio > 0));
        let says_all = !is_cylinder && of_default.is_none() && gain_of_motor.is_some();
        if !(ratio(&of_default) || ratio(&of_motor)) || (says_all && !follows) {
            prop_assert_eq!(&told, &[], "{}", text);
        }
        let biases: Vec<_> = [&of_default, &of_motor].into_iter().flatten().map(|bias| CompilerDoubt::Biased {
            told: format!("{bias_name}=\"{}\"", bias_text(bias)),
        }).collect();
        prop_assert!(told.iter().all(|doubt| biases.contains(doubt)));
    }

    /// What stands in a default is told of those that take it alone: it is not known here whether any does.
    #[test]
    fn a_default_is_told_of_what_takes_it(ratio in 1..9_u8, name in select(vec!["dampratio", "springdamper", "biasprm"])) {
        let value = match name {
            "dampratio" => ratio.to_string(),
            "springdamper" => format!("{ratio} 1"),
            _ => format!("0 -5 {ratio}"),
        };
        let text = format!("<mujoco><default><default class='unused'><x {name}='{value}'/></default></default></mujoco>");
        let told: Vec<String> = doubts("r.xml", &text).iter().map(ToString::to_string).collect();
        let [told] = &told[..] else { panic!("{told:?}") };
        prop_assert!(told.contains(&format!("{name}=\"{value}\": for each ")), "{}", told);
        prop_assert!(told.contains("that has this, by itself or by a default"), "{}", told);
    }

    /// In SDF, populations and added masses of a fluid.
    #[test]
    fn several_models_of_one_and_added_masses_are_told(
        links in prop::collection::vec((any::<[bool; 3]>(), select(vec!["a", "b", "c"])), 1..6),
    ) {
        let mut text = String::new();
        let (mut populated, mut added) = (None, None);
        for ([in_population, has_fluid, in_plugin], name) in &links {
            let fluid = "<fluid_added_mass><xx>3</xx></fluid_added_mass>";
            // Among the settings of a plugin it is nobody's.
            let more = match (has_fluid, in_plugin) {
                (true, true) => format!("</inertial><plugin>{fluid}</plugin>"),
                (true, false) => format!("{fluid}</inertial>"),
                (false, _) => "</inertial>".to_owned(),
            };
            let model = format!("<model name='m'><link name='{name}'><inertial><mass>2</mass>{more}</link></model>");
            text += &if *in_population {
                format!("<population name='p'><model_count>4</model_count>{model}</population>")
            } else {
                model
            };
            populated = populated.or(in_population.then_some(*name));
            added = added.or((*has_fluid && !in_plugin).then_some(*name));
        }
        let populated = populated.map(|link| CompilerDoubt::Populated { link: link.to_owned() });
        let added = added.map(|link| CompilerDoubt::FluidAdded { link: link.to_owned() });
        let expected: Vec<_> = populated.into_iter().chain(added).collect();
        prop_assert_eq!(doubts("r.sdf", &format!("<sdf version='1.11'><world name='w'>{text}</world></sdf>")), expected);
    }
}
