//! `**` with the same bits everywhere.
//!
//! Rhai computes `**` on floats by std's `powf`, and its fast operators cannot be replaced one by one. So the
//! token is replaced while the script is read: each `**` becomes a custom operator of ours. Custom operators
//! bind left and `**` binds right, therefore the k-th `**` of a chain gets the k-th of a row of operators, each
//! binding tighter than the one before, and `a ** b ** c` comes out as `a ** (b ** c)`.
//!
//! Rhai gives `**` the precedence 190 and the next tighter operators, the shifts, 210: a chain has at most 20.

use std::sync::{Mutex, PoisonError};

use rhai::{Dynamic, Engine, LexError, Token};

use super::{
    call::{kind_of, number_of},
    value::{Outcome, ScriptError},
};
use crate::{diag::Code, math};

/// Names of the operators, in order of precedence.
pub(super) const OPERATORS: [&str; 20] = [
    "**0", "**1", "**2", "**3", "**4", "**5", "**6", "**7", "**8", "**9", "**10", "**11", "**12", "**13",
    "**14", "**15", "**16", "**17", "**18", "**19",
];

/// Rhai's precedence of `**`.
const PRECEDENCE: u8 = 190;

/// Declares the operators to the parser.
pub(super) fn declare(engine: &mut Engine) -> Result<(), String> {
    for (name, precedence) in OPERATORS.iter().zip(PRECEDENCE..) {
        engine.register_custom_operator(name, precedence)?;
    }
    Ok(())
}

/// Counts the `**` of the chain at each level of brackets.
#[derive(Debug, Default)]
pub(super) struct Chains(Mutex<Vec<usize>>);

impl Chains {
    /// Replaces `**`, follows the brackets, and leaves every other token as it is.
    pub(super) fn map(&self, token: Token) -> Token {
        let mut levels = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match token {
            Token::PowerOf => {
                if levels.is_empty() {
                    levels.push(0);
                }
                let Some(level) = levels.last_mut() else {
                    return token;
                };
                *level += 1;
                match OPERATORS.get(*level - 1) {
                    Some(name) => Token::Custom(Box::new((*name).into())),
                    None => refuse("**", "at most 20 ** can stand in one chain"),
                }
            }
            Token::PowerOfAssign => refuse("**=", "**= is not available: write x = x ** y"),
            Token::LeftParen
            | Token::LeftBracket
            | Token::LeftBrace
            | Token::MapStart
            | Token::QuestionBracket => {
                if levels.is_empty() {
                    levels.push(0);
                }
                levels.push(0);
                token
            }
            Token::RightParen | Token::RightBracket | Token::RightBrace => {
                levels.pop();
                token
            }
            ref t if may_stand_in_a_chain(t) => token,
            _ => {
                if let Some(level) = levels.last_mut() {
                    *level = 0;
                }
                token
            }
        }
    }
}

/// Tokens between two `**` of one chain: operands and whatever binds tighter.
fn may_stand_in_a_chain(token: &Token) -> bool {
    matches!(
        token,
        Token::IntegerConstant(_)
            | Token::FloatConstant(_)
            | Token::Identifier(_)
            | Token::CharConstant(_)
            | Token::StringConstant(_)
            | Token::InterpolatedString(_)
            | Token::Reserved(_)
            | Token::Unit
            | Token::UnaryPlus
            | Token::UnaryMinus
            | Token::Bang
            | Token::Period
            | Token::Elvis
            | Token::DoubleColon
            | Token::LeftShift
            | Token::RightShift
            | Token::True
            | Token::False
            | Token::Else
            | Token::Comment(_)
    )
}

fn refuse(symbol: &str, why: &str) -> Token {
    Token::LexError(Box::new(LexError::ImproperSymbol(
        symbol.to_owned(),
        why.to_owned(),
    )))
}

/// `x ** y`: an int where both are ints and y is not negative, a float elsewhere.
pub(super) fn power(x: &Dynamic, y: &Dynamic) -> Outcome {
    if let (Ok(x), Ok(y)) = (x.as_int(), y.as_int())
        && y >= 0
    {
        let exact = u32::try_from(y).ok().and_then(|n| x.checked_pow(n));
        // 0, 1 and -1 stay small whatever the exponent.
        let exact = exact.or(match x {
            0 | 1 => Some(x),
            -1 => Some(if y % 2 == 0 { 1 } else { -1 }),
            _ => None,
        });
        return exact.map(Dynamic::from).ok_or_else(|| {
            ScriptError::new(format!("{x} ** {y} is too large for an int"))
                .class(Code::Arithmetic)
                .hint(format!("write {x}.0 ** {y} for a float"))
        });
    }
    match (number_of(x), number_of(y)) {
        (Some(x), Some(y)) => Ok(Dynamic::from(float_power(x, y))),
        _ => Err(ScriptError::new(format!(
            "** takes two numbers, not {} and {}",
            kind_of(x),
            kind_of(y)
        ))
        .class(Code::OperandTypes)),
    }
}

/// The square is a product, so that `x ** 2` and `x * x` are the same number.
pub(super) fn float_power(x: f64, y: f64) -> f64 {
    if y == 2.0 { x * x } else { math::pow(x, y) }
}
