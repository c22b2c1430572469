//! Python literals: as much of them as NumPy's headers use.

/// Brackets in brackets are deeper than this in no array of numbers.
const DEEPEST: u32 = 8;

/// A value of a literal.
pub(super) enum Value {
    Text(String),
    /// A number, a name or a keyword, as it is written.
    Word(String),
    /// A tuple or a list.
    Sequence(Vec<Value>),
    /// A dictionary or a set.
    Other,
}

/// The entries of a dictionary, which must be all of `text`.
///
/// # Errors
///
/// In words, where the text is no such literal.
pub(super) fn dictionary(text: &[u8]) -> Result<Vec<(String, Value)>, String> {
    let mut literal = Literal { rest: text, length: text.len() };
    let mut entries = Vec::new();
    literal.expect(b'{', "a dictionary")?;
    while !literal.ends_with(b'}')? {
        let Value::Text(key) = literal.value(1)? else {
            return Err("a key of the header is no text".to_owned());
        };
        literal.expect(b':', "a colon")?;
        entries.push((key, literal.value(1)?));
        literal.separator(b'}')?;
    }
    match literal.peek() {
        None => Ok(entries),
        Some(_) => Err("the header does not end after its dictionary".to_owned()),
    }
}

/// The rest of a literal that is being read.
struct Literal<'a> {
    rest: &'a [u8],
    /// The length of the whole, in bytes.
    length: usize,
}

impl Literal<'_> {
    /// The next byte that is no white space.
    fn peek(&mut self) -> Option<u8> {
        while let Some((b' ' | b'\t' | b'\x0c' | b'\r' | b'\n', rest)) = self.rest.split_first() {
            self.rest = rest;
        }
        self.rest.first().copied()
    }

    /// Skips the next byte if it is `wanted`.
    fn skip_if(&mut self, wanted: u8) -> bool {
        let is_next = self.peek() == Some(wanted);
        if is_next {
            self.rest = self.rest.get(1..).unwrap_or_default();
        }
        is_next
    }

    fn expect(&mut self, wanted: u8, name: &str) -> Result<(), String> {
        if self.skip_if(wanted) { Ok(()) } else { Err(self.unexpected(name)) }
    }

    fn unexpected(&mut self, wanted: &str) -> String {
        if self.peek().is_none() {
            return format!("the header ends where it must have {wanted}");
        }
        let at = self.length - self.rest.len();
        format!("the header must have {wanted} at its byte {at}")
    }

    /// Skips the bracket that ends a sequence, if it is next.
    fn ends_with(&mut self, end: u8) -> Result<bool, String> {
        match self.peek() {
            Some(_) => Ok(self.skip_if(end)),
            None => Err(self.unexpected("a closing bracket")),
        }
    }

    /// Skips a comma; `false` where the sequence ends instead.
    fn separator(&mut self, end: u8) -> Result<bool, String> {
        if self.skip_if(b',') {
            Ok(true)
        } else if self.peek() == Some(end) {
            Ok(false)
        } else {
            Err(self.unexpected("a comma or a closing bracket"))
        }
    }

    /// A value within `depth` brackets. The recursion ends at [`DEEPEST`].
    fn value(&mut self, depth: u32) -> Result<Value, String> {
        let (begin, end) = match self.peek() {
            Some(b'(') => (b'(', b')'),
            Some(b'[') => (b'[', b']'),
            Some(b'{') => (b'{', b'}'),
            Some(quote @ (b'\'' | b'"')) => return self.text(quote),
            _ => return self.word(),
        };
        if depth >= DEEPEST {
            return Err(format!("the header's brackets are nested more than {DEEPEST} deep"));
        }
        self.skip_if(begin);
        let mut values = Vec::new();
        let mut has_comma = false;
        while !self.ends_with(end)? {
            values.push(self.value(depth + 1)?);
            if end == b'}' && self.skip_if(b':') {
                self.value(depth + 1)?;
            }
            has_comma |= self.separator(end)?;
        }
        Ok(match (end, values.len()) {
            (b'}', _) => Value::Other,
            // In Python a value in round brackets is that value.
            (b')', 1) if !has_comma => values.remove(0),
            _ => Value::Sequence(values),
        })
    }

    fn text(&mut self, quote: u8) -> Result<Value, String> {
        self.skip_if(quote);
        let mut text = Vec::new();
        loop {
            match self.rest {
                // Escapes stay as they are written: no name of a type has any.
                [b'\\', escaped, rest @ ..] => {
                    text.extend([b'\\', *escaped]);
                    self.rest = rest;
                }
                [byte, rest @ ..] => {
                    self.rest = rest;
                    if *byte == quote {
                        return Ok(Value::Text(String::from_utf8_lossy(&text).into_owned()));
                    }
                    text.push(*byte);
                }
                [] => return Err("a text of the header does not end".to_owned()),
            }
        }
    }

    fn word(&mut self) -> Result<Value, String> {
        let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"_.+-".contains(byte);
        let length = self.rest.iter().take_while(|byte| is_part(byte)).count();
        let (word, rest) = self.rest.split_at(length);
        if word.is_empty() {
            return Err(self.unexpected("a value"));
        }
        self.rest = rest;
        match (word, rest) {
            // Python 2 marks a text as Unicode.
            (b"u", [quote @ (b'\'' | b'"'), ..]) => self.text(*quote),
            _ => Ok(Value::Word(String::from_utf8_lossy(word).into_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_no_dictionary_is_refused_in_words() {
        for (text, words) in [
            ("{'descr': '<f4'", "ends where it must have a comma or a closing bracket"),
            ("{'descr': '<f4", "a text of the header does not end"),
            ("{'descr' '<f4'}", "must have a colon at its byte 9"),
            ("{}{}", "does not end after its dictionary"),
            ("{1: 2}", "a key of the header is no text"),
            ("(1, 2)", "must have a dictionary at its byte 0"),
            ("", "the header ends where it must have a dictionary"),
        ] {
            let refused = dictionary(text.as_bytes()).err().unwrap();
            assert!(refused.contains(words), "{text}: {refused}");
        }
    }

    #[test]
    fn brackets_in_brackets_are_refused() {
        for open in ["[", "(", "{"] {
            let text = format!("{{'descr': {}", open.repeat(10_000));
            let refused = dictionary(text.as_bytes()).err().unwrap();
            assert_eq!(refused, "the header's brackets are nested more than 8 deep");
        }
    }
}
