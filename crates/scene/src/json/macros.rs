//! Macros that declare a format once, for the reader and the schema.

/// Declares an object with known keys: a struct that implements [`Record`](crate::json::Record) and
/// [`Decode`](crate::json::Decode).
///
/// Fields have a [`Field`](crate::json::Field) type, documentation (which becomes the schema's description), perhaps
/// another key than their name (`as "Key"`), and perhaps a default, as JSON text. `struct Name + comment` also lets
/// the object have a `comment`. [`Rule`](crate::json::Rule)s about which keys go together may follow: `with [...]`. A
/// field `at` is added: the object's place.
#[macro_export]
macro_rules! record {
    (
        $(#[doc = $doc:literal])+
        $vis:vis struct $name:ident $(+ $comment:ident)? {
            $(
                $(#[doc = $field_doc:literal])+
                $(#[allow($($allowed:tt)*)])?
                $field:ident $(as $key:literal)? : $type:ty $(= $default:literal)?
            ),* $(,)?
        }
        $(with [$($rule:expr),+ $(,)?])?
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug)]
        $vis struct $name {
            /// Place of the object.
            #[allow(dead_code, reason = "every record has its place, not every check needs it")]
            pub at: $crate::json::Span,
            $($(#[doc = $field_doc])+ $(#[allow($($allowed)*)])? pub $field: $type,)*
        }

        impl $crate::json::Record for $name {
            const KEYS: &'static [&'static str] = &[$($crate::record!(@key $field $($key)?)),*];
            const COMMENTED: bool = $crate::record!(@commented $($comment)?);
            const RULES: &'static [$crate::json::Rule] = &[$($($rule),+)?];

            #[allow(unused_variables, reason = "an object may have no fields")]
            fn read(
                object: &mut $crate::json::ObjectReader<'_>,
                reader: &mut $crate::json::Reader<'_>,
            ) -> Self {
                Self {
                    at: object.span(),
                    $($field: object.field(
                        $crate::record!(@key $field $($key)?),
                        $crate::record!(@default $($default)?),
                        &[$($field_doc),+],
                        reader,
                    ),)*
                }
            }

            fn description() -> ::std::string::String {
                $crate::json::describe(&[$($doc),+])
            }

            #[allow(unused_variables, reason = "an object may have no fields")]
            fn fields(schema: &mut $crate::json::SchemaBuilder) -> ::std::vec::Vec<$crate::json::FieldSchema> {
                ::std::vec![$($crate::json::FieldSchema::of::<$type>(
                    $crate::record!(@key $field $($key)?),
                    &[$($field_doc),+],
                    $crate::record!(@default $($default)?),
                    schema,
                )),*]
            }
        }

        impl $crate::json::Decode for $name {
            fn schema(schema: &mut $crate::json::SchemaBuilder) -> $crate::json::SchemaValue {
                schema.define(stringify!($name), |schema| $crate::json::record_schema::<Self>(schema))
            }

            fn decode(
                node: $crate::json::Node<'_>,
                reader: &mut $crate::json::Reader<'_>,
            ) -> ::std::option::Option<Self> {
                let mut object = $crate::json::ObjectReader::of::<Self>(node, None, reader)?;
                Some(<Self as $crate::json::Record>::read(&mut object, reader))
            }
        }
    };
    (@key $field:ident) => { stringify!($field) };
    (@key $field:ident $key:literal) => { $key };
    (@default) => { None };
    (@default $default:literal) => { Some($default) };
    (@commented) => { false };
    (@commented comment) => { true };
}

/// Declares an object of several kinds, told apart by a key: an enum of [`record!`]s that implements
/// [`Decode`](crate::json::Decode).
#[macro_export]
macro_rules! variants {
    (
        $(#[doc = $doc:literal])+
        $vis:vis enum $name:ident by $tag:literal {
            $($word:literal => $variant:ident($record:ty)),+ $(,)?
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug)]
        #[allow(dead_code, reason = "a kind without fields is all said by its word")]
        #[allow(clippy::large_enum_variant, reason = "forms live while a file is read, a few at a time")]
        $vis enum $name {
            $(#[doc = concat!("`", $word, "`")] $variant($record),)+
        }

        impl $crate::json::Decode for $name {
            fn schema(schema: &mut $crate::json::SchemaBuilder) -> $crate::json::SchemaValue {
                schema.define(stringify!($name), |schema| {
                    let kinds = ::std::vec![
                        $(($word, $crate::json::tagged_record_schema::<$record>(Some($tag), schema))),+
                    ];
                    $crate::json::one_of(&$crate::json::describe(&[$($doc),+]), $tag, kinds)
                })
            }

            fn decode(
                node: $crate::json::Node<'_>,
                reader: &mut $crate::json::Reader<'_>,
            ) -> ::std::option::Option<Self> {
                match $crate::json::tag(node, $tag, &[$($word),+], reader)? {
                    $($word => {
                        let mut object = $crate::json::ObjectReader::of::<$record>(node, Some($tag), reader)?;
                        Some(Self::$variant(<$record as $crate::json::Record>::read(&mut object, reader)))
                    })+
                    other => unreachable!("{other} is not among the words"),
                }
            }
        }
    };
}

/// Implements [`Decode`](crate::json::Decode) for an enum whose values are words.
#[macro_export]
macro_rules! keywords {
    ($type:ty { $($(#[doc = $doc:literal])+ $word:literal => $value:expr),+ $(,)? }) => {
        impl $crate::json::Decode for $type {
            fn schema(_: &mut $crate::json::SchemaBuilder) -> $crate::json::SchemaValue {
                $crate::json::words(&[$(($word, $crate::json::describe(&[$($doc),+]))),+])
            }

            fn decode(
                node: $crate::json::Node<'_>,
                reader: &mut $crate::json::Reader<'_>,
            ) -> ::std::option::Option<Self> {
                match $crate::json::keyword(node, &[$($word),+], reader)? {
                    $($word => Some($value),)+
                    other => unreachable!("{other} is not among the words"),
                }
            }
        }
    };
}

/// Declares a finite number within bounds, a pair of [`Bound`](std::ops::Bound)s.
#[macro_export]
macro_rules! number {
    ($(#[doc = $doc:literal])+ $vis:vis struct $name:ident in $bounds:expr;) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $name(pub f64);

        impl $crate::json::Decode for $name {
            fn schema(_: &mut $crate::json::SchemaBuilder) -> $crate::json::SchemaValue {
                $crate::json::bounded_schema($bounds)
            }

            fn decode(
                node: $crate::json::Node<'_>,
                reader: &mut $crate::json::Reader<'_>,
            ) -> ::std::option::Option<Self> {
                $crate::json::bounded(node, $bounds, reader).map(Self)
            }
        }
    };
}
