//! Letters for legends: our own drawings of five by seven pixels, so that a picture needs no font of the machine.

/// Width and height of a letter, pixels.
pub(super) const GLYPH: [usize; 2] = [5, 7];
/// From the left of a letter to that of the next, pixels.
pub(super) const ADVANCE: usize = GLYPH[0] + 1;

/// The letters, row after row from the top.
#[rustfmt::skip]
const GLYPHS: [(char, &str); 48] = [
    ('0', ".###. #...# #..## #.#.# ##..# #...# .###."),
    ('1', "..#.. .##.. ..#.. ..#.. ..#.. ..#.. .###."),
    ('2', ".###. #...# ....# ..##. .#... #.... #####"),
    ('3', ".###. #...# ....# ..##. ....# #...# .###."),
    ('4', "...#. ..##. .#.#. #..#. ##### ...#. ...#."),
    ('5', "##### #.... ####. ....# ....# #...# .###."),
    ('6', "..##. .#... #.... ####. #...# #...# .###."),
    ('7', "##### ....# ...#. ..#.. ..#.. ..#.. ..#.."),
    ('8', ".###. #...# #...# .###. #...# #...# .###."),
    ('9', ".###. #...# #...# .#### ....# ...#. .##.."),
    ('.', "..... ..... ..... ..... ..... .##.. .##.."),
    (',', "..... ..... ..... ..... .##.. ..#.. .#..."),
    ('-', "..... ..... ..... .###. ..... ..... ....."),
    ('+', "..... ..#.. ..#.. ##### ..#.. ..#.. ....."),
    ('/', "....# ....# ...#. ..#.. .#... #.... #...."),
    ('%', "##..# ##..# ...#. ..#.. .#... #..## #..##"),
    ('(', "...#. ..#.. ..#.. ..#.. ..#.. ..#.. ...#."),
    (')', ".#... ..#.. ..#.. ..#.. ..#.. ..#.. .#..."),
    ('²', ".##.. #..#. ..#.. .#... ####. ..... ....."),
    (' ', "..... ..... ..... ..... ..... ..... ....."),
    ('?', ".###. #...# ....# ..##. ..#.. ..... ..#.."),
    ('W', "#...# #...# #...# #.#.# #.#.# ##.## #...#"),
    ('a', "..... ..... .###. ....# .#### #...# .####"),
    ('b', "#.... #.... ####. #...# #...# #...# ####."),
    ('c', "..... ..... .###. #.... #.... #...# .###."),
    ('d', "....# ....# .#### #...# #...# #...# .####"),
    ('e', "..... ..... .###. #...# ##### #.... .###."),
    ('f', "..##. .#... ####. .#... .#... .#... .#..."),
    ('g', "..... .#### #...# #...# .#### ....# .###."),
    ('h', "#.... #.... ####. #...# #...# #...# #...#"),
    ('i', "..#.. ..... .##.. ..#.. ..#.. ..#.. .###."),
    ('j', "...#. ..... ..##. ...#. ...#. #..#. .##.."),
    ('k', "#.... #.... #..#. #.#.. ##... #.#.. #..#."),
    ('l', ".##.. ..#.. ..#.. ..#.. ..#.. ..#.. .###."),
    ('m', "..... ..... ##.#. #.#.# #.#.# #.#.# #.#.#"),
    ('n', "..... ..... ####. #...# #...# #...# #...#"),
    ('o', "..... ..... .###. #...# #...# #...# .###."),
    ('p', "..... ####. #...# #...# ####. #.... #...."),
    ('q', "..... .#### #...# #...# .#### ....# ....#"),
    ('r', "..... ..... #.##. ##... #.... #.... #...."),
    ('s', "..... ..... .#### #.... .###. ....# ####."),
    ('t', ".#... .#... ####. .#... .#... .#... ..##."),
    ('u', "..... ..... #...# #...# #...# #...# .####"),
    ('v', "..... ..... #...# #...# #...# .#.#. ..#.."),
    ('w', "..... ..... #...# #...# #.#.# #.#.# .#.#."),
    ('x', "..... ..... #...# .#.#. ..#.. .#.#. #...#"),
    ('y', "..... #...# #...# #...# .#### ....# .###."),
    ('z', "..... ..... ##### ...#. ..#.. .#... #####"),
];

/// The width of a line of text, pixels.
pub(super) fn text_width(text: &str) -> usize {
    (text.chars().count() * ADVANCE).saturating_sub(1)
}

/// The pixels of a line of text: columns and rows from its top left. A letter that is not drawn here becomes a question mark.
pub(super) fn text_pixels(text: &str) -> impl Iterator<Item = [usize; 2]> {
    text.chars().enumerate().flat_map(|(place, letter)| {
        let of = |wanted: char| GLYPHS.iter().find(|(drawn, _)| *drawn == wanted).map(|(_, rows)| *rows);
        let rows = of(letter).or_else(|| of('?')).expect("a question mark is drawn");
        rows.split(' ').enumerate().flat_map(move |(y, row)| {
            row.bytes().enumerate().filter(|(_, dot)| *dot == b'#').map(move |(x, _)| [place * ADVANCE + x, y])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_differ_and_have_five_by_seven_pixels() {
        for (i, (letter, rows)) in GLYPHS.iter().enumerate() {
            let rows: Vec<&str> = rows.split(' ').collect();
            assert!(rows.len() == GLYPH[1] && rows.iter().all(|row| row.len() == GLYPH[0]), "{letter}");
            assert!(GLYPHS[..i].iter().all(|(other, drawn)| other != letter && *drawn != rows.join(" ")), "{letter}");
        }
        assert_eq!(text_width(""), 0);
        assert_eq!(text_width("12"), 11);
        assert_eq!(text_pixels("λ").collect::<Vec<_>>(), text_pixels("?").collect::<Vec<_>>());
        assert!(text_pixels("12").all(|[x, y]| x < 11 && y < 7));
    }
}
