//! The places where an operator or the result of a function can be exchanged, and a source text in which each is.

use proc_macro2::Span;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Expr, ExprBinary, ExprUnary, UnOp};

/// A place where a file can be wrong.
#[derive(Clone, Debug)]
pub struct Mutant {
    pub line: usize,
    pub column: usize,
    /// The operator, or the result of a function, and what it is exchanged for; nothing for an operator that is left out.
    pub from: &'static str,
    pub to: &'static str,
    edits: [Edit; 3],
    length: usize,
}

/// Bytes of the source exchanged for a text in which `#` stands for the question whether the mutant is on.
#[derive(Clone, Debug)]
struct Edit {
    start: usize,
    end: usize,
    text: String,
}

impl Edit {
    fn insert(at: usize, text: impl Into<String>) -> Self {
        Self { start: at, end: at, text: text.into() }
    }
}

/// What is exchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum What {
    #[default]
    Operators,
    /// What functions return, for what does not depend on anything.
    Results,
}

/// All mutants of a source text.
///
/// # Errors
/// If it is no Rust.
pub fn mutants(source: &str, what: What) -> Result<Vec<Mutant>, String> {
    let file = syn::parse_file(source).map_err(|error| error.to_string())?;
    let mut finder = Finder { what, ..Finder::default() };
    finder.visit_file(&file);
    Ok(finder.mutants)
}

/// The source with some of its mutants, each with its number.
pub fn rewritten<'a>(source: &str, mutants: impl IntoIterator<Item = (u32, &'a Mutant)>) -> String {
    // Of what begins at one place the longer expression begins first, of what ends at one place the shorter ends first.
    let mut edits: Vec<(usize, usize, isize, String, usize)> = Vec::new();
    for (number, mutant) in mutants {
        let length = mutant.length as isize;
        for (edit, order) in mutant.edits.iter().zip([-length, 0, length]) {
            let side = if order <= 0 { 1 } else { 0 };
            let text = edit.text.replace('#', &format!("crate::mutant_is_on({number})"));
            edits.push((edit.start, side, order, text, edit.end));
        }
    }
    edits.sort_by_key(|&(start, side, order, ..)| (start, side, order));
    let (mut out, mut at) = (String::new(), 0);
    for (start, _, _, text, end) in edits {
        out += &source[at..start];
        out += &text;
        at = end;
    }
    out + &source[at..]
}

#[derive(Default)]
struct Finder {
    what: What,
    mutants: Vec<Mutant>,
}

impl Finder {
    /// The results of a function, each in a line of its own, for one may not compile.
    fn results(&mut self, signature: &syn::Signature, body: &syn::Block) {
        if self.what != What::Results {
            return;
        }
        let place = signature.ident.span().start();
        let start = body.brace_token.span.open().byte_range().end;
        for to in constants(&signature.output) {
            self.mutants.push(Mutant {
                line: place.line,
                column: place.column + 1,
                from: "result",
                to,
                length: 0,
                edits: [format!("\nif # {{ return {to}; }}\n"), String::new(), String::new()]
                    .map(|text| Edit::insert(start, text)),
            });
        }
    }

    fn add(&mut self, whole: Span, operator: Span, [from, to]: [&'static str; 2], texts: [String; 3]) {
        let (range, operator_range) = (whole.byte_range(), operator.byte_range());
        let [before, instead, after] = texts;
        self.mutants.push(Mutant {
            line: operator.start().line,
            column: operator.start().column + 1,
            from,
            to,
            length: range.len(),
            edits: [
                Edit::insert(range.start, before),
                Edit { start: operator_range.start, end: operator_range.end, text: instead },
                Edit::insert(range.end, after),
            ],
        });
    }
}

/// What a function may return of the type that it says, whatever it is asked.
fn constants(output: &syn::ReturnType) -> &'static [&'static str] {
    let ty = match output {
        syn::ReturnType::Default => return &["()"],
        syn::ReturnType::Type(_, ty) => ty,
    };
    let syn::Type::Path(path) = &**ty else { return &["Default::default()"] };
    let Some(last) = path.path.segments.last() else { return &[] };
    match last.ident.to_string().as_str() {
        "bool" => &["true", "false"],
        "f64" | "f32" => &["0.0", "1.0", "-1.0"],
        "R" => &["R::from_f64(0.0)", "R::from_f64(1.0)", "R::from_f64(-1.0)"],
        "usize" | "u64" | "u32" | "u16" | "u8" | "isize" | "i64" | "i32" => &["0", "1"],
        "Lanes" => &["Lanes::ZERO", "Lanes::ONE"],
        "Option" => &["None", "Some(Default::default())"],
        "Result" => &["Ok(Default::default())"],
        _ => &["Default::default()"],
    }
}

/// Whether an attribute says that an item is compiled for tests alone.
fn for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes
        .iter()
        .any(|a| a.path().is_ident("cfg") && a.meta.require_list().is_ok_and(|l| l.tokens.to_string() == "test"))
}

/// Whether an expression declares names: those of `if let … && …`.
fn declares(expr: &Expr) -> bool {
    match expr {
        Expr::Let(_) => true,
        Expr::Binary(ExprBinary { left, right, .. }) => declares(left) || declares(right),
        _ => false,
    }
}

impl<'ast> Visit<'ast> for Finder {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !for_tests(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    // What is computed when it is compiled can ask nothing.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_expr_repeat(&mut self, expr: &'ast syn::ExprRepeat) {
        self.visit_expr(&expr.expr);
    }
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if item.sig.constness.is_none() && !for_tests(&item.attrs) {
            self.results(&item.sig, &item.block);
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if item.sig.constness.is_none() && !for_tests(&item.attrs) {
            self.results(&item.sig, &item.block);
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(body) = &item.default {
            self.results(&item.sig, body);
        }
        visit::visit_trait_item_fn(self, item);
    }

    fn visit_expr_binary(&mut self, expr: &'ast ExprBinary) {
        visit::visit_expr_binary(self, expr);
        let pair = match expr.op {
            BinOp::Add(_) => ["+", "-"],
            BinOp::Sub(_) => ["-", "+"],
            BinOp::Mul(_) => ["*", "/"],
            BinOp::Div(_) => ["/", "*"],
            BinOp::Rem(_) => ["%", "/"],
            BinOp::BitAnd(_) => ["&", "|"],
            BinOp::BitOr(_) => ["|", "&"],
            BinOp::BitXor(_) => ["^", "|"],
            BinOp::Shl(_) => ["<<", ">>"],
            BinOp::Shr(_) => [">>", "<<"],
            BinOp::Lt(_) => ["<", ">"],
            BinOp::Le(_) => ["<=", ">"],
            BinOp::Gt(_) => [">", "<"],
            BinOp::Ge(_) => [">=", "<"],
            BinOp::Eq(_) => ["==", "!="],
            BinOp::Ne(_) => ["!=", "=="],
            BinOp::And(_) => ["&&", "||"],
            BinOp::Or(_) => ["||", "&&"],
            BinOp::AddAssign(_) => ["+=", "-="],
            BinOp::SubAssign(_) => ["-=", "+="],
            BinOp::MulAssign(_) => ["*=", "/="],
            BinOp::DivAssign(_) => ["/=", "*="],
            BinOp::BitAndAssign(_) => ["&=", "|="],
            BinOp::BitOrAssign(_) => ["|=", "&="],
            _ => return,
        };
        if self.what != What::Operators {
            return;
        }
        let [from, to] = pair;
        let choice = |l: &str, r: &str| format!("if # {{ {l} {to} {r} }} else {{ {l} {from} {r} }}");
        let texts = match expr.op {
            BinOp::And(_) | BinOp::Or(_) if declares(&expr.left) || declares(&expr.right) => return,
            // The right side is asked only where the left one does not tell.
            BinOp::And(_) | BinOp::Or(_) => {
                let asked = if matches!(expr.op, BinOp::And(_)) { "mutant_l != #" } else { "mutant_l == #" };
                ["({ let mutant_l: bool = ".into(), format!("; if {asked} {{ "), " } else { mutant_l } })".into()]
            }
            BinOp::Lt(_) | BinOp::Le(_) | BinOp::Gt(_) | BinOp::Ge(_) | BinOp::Eq(_) | BinOp::Ne(_) => {
                let end = format!(")) {{ (mutant_l, mutant_r) => {} }})", choice("mutant_l", "mutant_r"));
                ["(match (&(".into(), "), &(".into(), end]
            }
            BinOp::AddAssign(_)
            | BinOp::SubAssign(_)
            | BinOp::MulAssign(_)
            | BinOp::DivAssign(_)
            | BinOp::BitAndAssign(_)
            | BinOp::BitOrAssign(_) => {
                let end = format!(") {{ (mutant_l, mutant_r) => {} }}", choice("*mutant_l", "mutant_r"));
                ["match (&mut ".into(), ", ".into(), end]
            }
            _ => {
                let end = format!(") {{ (mutant_l, mutant_r) => {} }})", choice("mutant_l", "mutant_r"));
                ["(match (".into(), ", ".into(), end]
            }
        };
        self.add(expr.span(), expr.op.span(), pair, texts);
    }

    fn visit_expr_unary(&mut self, expr: &'ast ExprUnary) {
        visit::visit_expr_unary(self, expr);
        let from = match expr.op {
            UnOp::Neg(_) if self.what == What::Operators => "-",
            UnOp::Not(_) if self.what == What::Operators => "!",
            _ => return,
        };
        let end = format!(" {{ mutant_v => if # {{ mutant_v }} else {{ {from}mutant_v }} }})");
        self.add(expr.span(), expr.op.span(), [from, ""], ["(match ".into(), String::new(), end]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_on_changes_and_all_else_stays() {
        let source = "fn f(a: f64, b: f64) -> bool { let mut c = a + b * -a; c += 1.0; c < 2.0 && a - b - c > 0.0 }";
        let all = mutants(source, What::Operators).unwrap();
        let names: Vec<_> = all.iter().map(|m| (m.from, m.to)).collect();
        let wanted = [
            ("-", ""),
            ("*", "/"),
            ("+", "-"),
            ("+=", "-="),
            ("<", ">"),
            ("-", "+"),
            ("-", "+"),
            (">", "<"),
            ("&&", "||"),
        ];
        assert_eq!(names, wanted);
        let text = rewritten(source, all.iter().enumerate().map(|(i, m)| (i as u32, m)));
        syn::parse_file(&text).unwrap();
        assert_eq!(text.matches("mutant_is_on").count(), all.len());
        assert_eq!(rewritten(source, []), source);
    }

    #[test]
    fn nothing_is_changed_in_constants_tests_and_patterns() {
        let source = "const A: f64 = 1.0 + 2.0; #[cfg(test)] mod tests { fn f() -> i32 { 1 + 1 } } fn g(x: i32) -> [i32; 1 + 1] { \
                      match x { -1 => [0; 1 + 1], _ => [1, 2] } }";
        assert!(mutants(source, What::Operators).unwrap().is_empty());
    }

    #[test]
    fn functions_return_what_their_types_allow() {
        let source = "impl A { fn f(&self) -> bool { self.0 > 1 } } trait B { fn g(&self); fn h(&self) -> f64 { 2.0 + 1.0 } } const fn c() -> u8 { 3 }";
        let all = mutants(source, What::Results).unwrap();
        let names: Vec<_> = all.iter().map(|m| (m.from, m.to)).collect();
        assert_eq!(names, ["true", "false", "0.0", "1.0", "-1.0"].map(|to| ("result", to)));
        let text = rewritten(source, all.iter().enumerate().map(|(i, m)| (i as u32, m)));
        syn::parse_file(&text).unwrap();
        assert!(text.contains("if crate::mutant_is_on(1) { return false; }"), "{text}");
    }
}
