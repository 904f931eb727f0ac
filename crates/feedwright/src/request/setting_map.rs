//! Settings of controllers: a map from names to values, read in its order and written sorted.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use serde_json::Value;

/// A setting as `--set` has it; `Null` is a setting without a value.
pub(super) fn text((name, value): &(String, Value)) -> String {
    match value {
        Value::Null => name.clone(),
        Value::String(value) => format!("{name}={value}"),
        value => format!("{name}={value}"),
    }
}

/// A setting from its text in `--set`.
pub(crate) fn setting(text: &str) -> (String, Value) {
    match text.split_once('=') {
        Some((name, value)) => (name.to_owned(), value.into()),
        None => (text.to_owned(), Value::Null),
    }
}

pub(super) fn serialize<S: Serializer>(
    settings: &[(String, Value)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let sorted: BTreeMap<&str, &Value> = settings.iter().map(|(k, v)| (k.as_str(), v)).collect();
    sorted.serialize(serializer)
}

pub(super) fn deserialize<'d, D: Deserializer<'d>>(
    deserializer: D,
) -> Result<Vec<(String, Value)>, D::Error> {
    struct InOrder;

    impl<'d> Visitor<'d> for InOrder {
        type Value = Vec<(String, Value)>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a map")
        }

        fn visit_map<A: MapAccess<'d>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut settings = Vec::new();
            while let Some(setting) = map.next_entry()? {
                settings.push(setting);
            }
            Ok(settings)
        }
    }

    deserializer.deserialize_map(InOrder)
}
