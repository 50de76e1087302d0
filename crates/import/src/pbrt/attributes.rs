//! What holds for all directives that follow: parameters by `Attribute`, the times of transforms, the space of colours.

use std::cell::Cell;
use std::rc::Rc;

use etalon_scene::shortened;

use super::Reading;
use super::arguments::Arguments;
use super::parameters::{Parameter, Parameters};

/// What `Attribute` may be about.
const TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];
/// Most parameters that attributes in force state of a kind of directives.
const MOST_STATED: usize = 64;
/// Most values that directives have by attributes, all of them together: each may make files of them.
const MOST_INHERITED: usize = 1 << 24;
/// Most parameters of attributes that are remembered, to list those that nothing reads.
const MOST_REMEMBERED: usize = 10_000;

/// Parameters that directives of a kind have, unless they state them.
#[derive(Clone, Debug, Default)]
pub(super) struct Attributes(Rc<Vec<(usize, Rc<Parameter>)>>);

/// Which parameters given by `Attribute` were used, and how many values they handed on.
#[derive(Debug, Default)]
pub(super) struct Inheritance {
    /// How many values directives have by them.
    handed: usize,
    /// Where each is stated, what to say if nothing reads it, and whether something has.
    stated: Vec<(String, String, Rc<Cell<bool>>)>,
}

impl Reading<'_, '_> {
    /// Adds parameters by `Attribute`; those that were stated last hold.
    pub(super) fn attribute(&mut self, target: &str, list: Parameters, place: &str) -> Result<(), String> {
        let known = TARGETS.iter().position(|known| *known == target);
        let of = known.ok_or_else(|| format!("{place}: \"{target}\" is no target of attributes"))?;
        let stated = Rc::make_mut(&mut self.state.attributes.0);
        for parameter in list.all {
            let label = format!("\"{} {}\" is ignored", parameter.kind, parameter.name);
            let same = stated.iter().position(|(other, known)| *other == of && known.name == parameter.name);
            if same.is_none() && stated.iter().filter(|(other, _)| *other == of).count() == MOST_STATED {
                let what = format!("{label}: attributes state more than {MOST_STATED} parameters of a {target}");
                self.builder.leave_out(&parameter.place, what);
                continue;
            }
            if self.inheritance.stated.len() < MOST_REMEMBERED {
                let what = shortened(format!("{label}: no directive that follows reads it"));
                self.inheritance.stated.push((parameter.place.clone(), what, parameter.used()));
            }
            match same {
                Some(at) => stated[at].1 = parameter,
                None => stated.push((of, parameter)),
            }
        }
        Ok(())
    }

    /// The parameters of a directive, and those of attributes that it does not state.
    pub(super) fn inheriting(&mut self, target: &str, arguments: &mut Arguments<'_>) -> Result<Parameters, String> {
        let mut list = arguments.parameters()?;
        let of_target = self.state.attributes.0.iter().filter(|(of, _)| TARGETS[*of] == target);
        let missing: Vec<Rc<Parameter>> = of_target
            .filter(|(_, parameter)| list.all.iter().all(|own| own.name != parameter.name))
            .map(|(_, parameter)| Rc::clone(parameter))
            .collect();
        self.inheritance.handed += missing.iter().map(|parameter| parameter.size()).sum::<usize>();
        if self.inheritance.handed > MOST_INHERITED {
            return Err(format!("{}: directives have more than {MOST_INHERITED} values by Attribute", arguments.place));
        }
        list.all.extend(missing);
        Ok(list)
    }

    /// Lists the parameters of attributes that no directive has read.
    pub(super) fn list_unread_attributes(&mut self) {
        for (place, what, used) in std::mem::take(&mut self.inheritance.stated) {
            if !used.get() {
                self.builder.leave_out(place, what);
            }
        }
    }

    /// Which transforms the following directives change.
    pub(super) fn active_transform(&mut self, time: &str, place: &str) -> Result<(), String> {
        self.state.at_end = match time {
            "All" | "StartTime" => false,
            "EndTime" => {
                let what = "motion is not read: things stay where they are when the shutter opens";
                self.builder.leave_out(place, what);
                true
            }
            other => return Err(format!("{place}: \"{other}\" is not the time of a transform")),
        };
        Ok(())
    }

    pub(super) fn colour_space(&mut self, name: &str, place: &str) {
        if !name.eq_ignore_ascii_case("srgb") {
            let what = format!("the colours that follow are of the space \"{name}\": they are read as those of sRGB");
            self.builder.approximate(place, what);
        }
    }
}
