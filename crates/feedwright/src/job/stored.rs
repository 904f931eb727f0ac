//! How a job is serialised: what has a file of its own as the text of that file, what stands in a
//! table by its name.

use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, Serializer};

/// A machine.
pub(super) mod machine {
    use super::{Deserialize, Deserializer, Error, Serializer};
    use feedwright_sim::Machine;

    pub(in super::super) fn serialize<S: Serializer>(
        machine: &Machine,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&machine.text())
    }

    pub(in super::super) fn deserialize<'d, D: Deserializer<'d>>(
        deserializer: D,
    ) -> Result<Machine, D::Error> {
        Machine::parse("machine", &String::deserialize(deserializer)?).map_err(Error::custom)
    }
}

/// A model, where there is one.
pub(super) mod model {
    use super::{Deserialize, Deserializer, Error, Serializer};
    use feedwright_ident::Model;

    pub(in super::super) fn serialize<S: Serializer>(
        model: &Option<Model>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match model {
            Some(model) => serializer.serialize_some(&model.text()),
            None => serializer.serialize_none(),
        }
    }

    pub(in super::super) fn deserialize<'d, D: Deserializer<'d>>(
        deserializer: D,
    ) -> Result<Option<Model>, D::Error> {
        let text = Option::<String>::deserialize(deserializer)?;
        text.map(|text| Model::parse("model", &text))
            .transpose()
            .map_err(Error::custom)
    }
}

/// A row of the table of controls, where one is asked for.
pub(super) mod target {
    use super::{Deserialize, Deserializer, Error, Serialize, Serializer};
    use crate::correct::TargetControl;

    pub(in super::super) fn serialize<S: Serializer>(
        target: &Option<&'static TargetControl>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        target.map(|target| target.name).serialize(serializer)
    }

    pub(in super::super) fn deserialize<'d, D: Deserializer<'d>>(
        deserializer: D,
    ) -> Result<Option<&'static TargetControl>, D::Error> {
        let find = |name: String| {
            TargetControl::find(&name)
                .ok_or_else(|| D::Error::custom(format!("no control is called '{name}'")))
        };
        Option::<String>::deserialize(deserializer)?
            .map(find)
            .transpose()
    }
}

/// A row of the table of controllers.
pub(super) mod entry {
    use super::{Deserialize, Deserializer, Error, Serializer};
    use crate::controllers::{CONTROLLERS, Entry};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
    pub(in super::super) fn serialize<S: Serializer>(
        entry: &&'static Entry,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(entry.name)
    }

    pub(in super::super) fn deserialize<'d, D: Deserializer<'d>>(
        deserializer: D,
    ) -> Result<&'static Entry, D::Error> {
        let name = String::deserialize(deserializer)?;
        CONTROLLERS
            .find(&name)
            .ok_or_else(|| D::Error::custom(format!("no controller is called '{name}'")))
    }
}
