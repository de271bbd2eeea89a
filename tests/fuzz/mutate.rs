//! Inputs made from others: bits and bytes changed, pieces cut, doubled, exchanged, and words put in that readers stumble over.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Words that readers of numbers, texts and tables stumble over.
const WORDS: &[&str] = &[
    "0",
    "-1",
    "1e999",
    "-1e999",
    "nan",
    "inf",
    "1e-320",
    "99999999999999999999",
    "-9223372036854775808",
    "4294967296",
    "0.5",
    "100000",
    "\"\"",
    "\"1e400 m\"",
    "\"-3 kN\"",
    "\"5 furlongs\"",
    "[",
    "]",
    "[[",
    "{",
    "}",
    "=",
    ",",
    ",,,,",
    "\n",
    "\r\n",
    "\"",
    "#",
    "\u{feff}",
    "\0",
    "\u{1F52E}",
    "é",
    "\t",
    "true",
    "null",
    "[[load]]\n",
    "[lens]\n",
    "1979-05-27",
    "'''",
    "\\u0000",
    "0x7f",
];

/// A stream of mutations of a corpus.
pub struct Mutations<'a> {
    corpus: &'a [Vec<u8>],
    chance: Xoshiro256PlusPlus,
}

impl<'a> Mutations<'a> {
    pub fn new(corpus: &'a [Vec<u8>], seed: u64) -> Self {
        Self { corpus, chance: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }

    /// A number below `count`, or zero.
    fn below(&mut self, count: usize) -> usize {
        if count == 0 { 0 } else { (self.chance.next_u64() % count as u64) as usize }
    }

    fn range(&mut self, length: usize) -> std::ops::Range<usize> {
        let from = self.below(length + 1);
        let most = (length - from).min(64);
        from..from + self.below(most + 1)
    }

    /// One to eight changes to an input of the corpus.
    pub fn next_input(&mut self) -> Vec<u8> {
        let pick = self.below(self.corpus.len());
        let mut bytes = self.corpus[pick].clone();
        for _ in 0..=self.below(8) {
            self.change(&mut bytes);
        }
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len() + 1);
        match self.below(10) {
            0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            1 if at < bytes.len() => bytes[at] = self.chance.next_u64() as u8,
            2 => drop(bytes.drain(self.range(bytes.len()))),
            3 => {
                let piece = bytes[self.range(bytes.len())].to_vec();
                drop(bytes.splice(at..at, piece));
            }
            4 => bytes.truncate(at),
            5 => {
                let other = &self.corpus[self.below(self.corpus.len())];
                let piece = other[self.range(other.len())].to_vec();
                drop(bytes.splice(at..at, piece));
            }
            6 | 7 => {
                let word = WORDS[self.below(WORDS.len())].bytes();
                drop(bytes.splice(at..at, word));
            }
            // A whole number or quantity gives way to a word.
            8 => {
                let digits: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k].is_ascii_digit()).collect();
                if let Some(&from) = digits.get(self.below(digits.len())) {
                    let length = bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
                    let word = WORDS[self.below(WORDS.len())].bytes();
                    drop(bytes.splice(from..from + length, word));
                }
            }
            _ => {
                // Two lines change places.
                let mut lines: Vec<Vec<u8>> = bytes.split(|&b| b == b'\n').map(<[u8]>::to_vec).collect();
                let (a, b) = (self.below(lines.len()), self.below(lines.len()));
                lines.swap(a, b);
                *bytes = lines.join(&b'\n');
            }
        }
    }
}
