//! One instance of a STEP file with its arguments, and what keeps a file from being read.

use std::ops::Range;

/// One `#id=KEYWORD(…);` of a DATA section.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Instance {
    /// The number after `#`.
    pub id: u64,
    /// From `#` to one past `;`.
    pub span: Range<usize>,
    /// The keyword as written; empty for a complex instance.
    pub keyword: Range<usize>,
    /// From one past the opening parenthesis to the closing one.
    pub args: Range<usize>,
}

/// One argument with its bytes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Arg {
    /// Where it stands, white space excluded.
    pub span: Range<usize>,
    /// What it is.
    pub value: Value,
}

/// What an argument is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// `$`, `*` or a binary literal.
    Null,
    /// `#12`.
    Ref(u64),
    /// A number.
    Number(f64),
    /// `'…'`; the content stands in the span.
    Text,
    /// `.NAME.`, dots excluded, as written.
    Enum(String),
    /// `(…)`.
    List(Vec<Arg>),
    /// `KEYWORD(…)`.
    Typed(String, Vec<Arg>),
}

impl Arg {
    /// The instance it refers to.
    pub fn id(&self) -> Option<u64> {
        if let Value::Ref(id) = self.value { Some(id) } else { None }
    }

    /// Its number, a typed one's too.
    pub fn number(&self) -> Option<f64> {
        match &self.value {
            Value::Number(v) => Some(*v),
            Value::Typed(_, args) => args.first()?.number(),
            _ => None,
        }
    }

    /// Its items; empty for anything but a list.
    pub fn list(&self) -> &[Arg] {
        if let Value::List(items) = &self.value { items } else { &[] }
    }

    /// The numbers of a list.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.list().iter().map(Arg::number).collect()
    }

    /// The instances a list refers to.
    pub fn ids(&self) -> Vec<u64> {
        self.list().iter().filter_map(Arg::id).collect()
    }

    /// Whether it is `.name.`.
    pub fn is(&self, name: &str) -> bool {
        matches!(&self.value, Value::Enum(e) if e.eq_ignore_ascii_case(name))
    }
}

/// What keeps a file from being read, at a byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    /// Where.
    pub at: usize,
    /// `found …, expected …`.
    pub text: String,
}
