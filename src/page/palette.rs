//! Colours of materials, and the letter that each bears where its colour may not be enough.

/// How a material is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink {
    /// Colour of its spheres.
    pub fill: &'static str,
    /// Colour of what is written on them.
    pub text: &'static str,
    /// Its letter, for readers and printers without colours.
    pub letter: char,
}

const fn of(letter: char, fill: &'static str, text: &'static str) -> Ink {
    Ink { fill, text, letter }
}

/// By the material's place in a layout's palette: the host first, then the lens. Two of them differ by at least 15 units of CIELAB
/// for every kind of colour blindness (a test holds them to it); after Okabe and Ito (2008), with lightness drawn apart.
pub const MATERIALS: [Ink; 8] = [
    of('H', "#b4bcc5", "#1a1c1f"),
    of('A', "#e69f00", "#1a1c1f"),
    of('B', "#0b5394", "#ffffff"),
    of('C', "#12806a", "#ffffff"),
    of('D', "#c96fa4", "#1a1c1f"),
    of('E', "#63b8ee", "#1a1c1f"),
    of('F', "#9e3a00", "#ffffff"),
    of('G', "#f5e960", "#1a1c1f"),
];

/// How the material at a place of the palette is drawn. Beyond the eighth, colours come again, without the host's; letters then tell.
pub fn ink(place: usize) -> Ink {
    let others = MATERIALS.len() - 1;
    match place {
        0 => MATERIALS[0],
        _ => {
            let letter = char::from(b'A' + ((place - 1) % 26) as u8);
            // The letter of the host belongs to the host.
            let letter = if letter >= 'H' { char::from(letter as u8 + 1) } else { letter };
            Ink { letter, ..MATERIALS[1 + (place - 1) % others] }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Matrix = [[f64; 3]; 3];

    /// What each kind of colour blindness makes of linear sRGB. Source: G. M. Machado, M. M. Oliveira and L. A. F. Fernandes, IEEE
    /// Trans. Vis. Comput. Graph. 15, 1291 (2009), severity 1.
    const SEEN: [(&str, Matrix); 4] = [
        ("all colours", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        (
            "protanopia",
            [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        ),
        (
            "deuteranopia",
            [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        ),
        (
            "tritanopia",
            [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
        ),
    ];

    fn linear(colour: &str) -> [f64; 3] {
        [1, 3, 5].map(|at| {
            let part = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        })
    }

    fn times(matrix: &Matrix, v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum::<f64>())
    }

    /// CIELAB under D65 (CIE 15:2004).
    fn lab(linear: [f64; 3]) -> [f64; 3] {
        let to_xyz = [
            [0.412_456_4, 0.357_576_1, 0.180_437_5],
            [0.212_672_9, 0.715_152_2, 0.072_175_0],
            [0.019_333_9, 0.119_192_0, 0.950_304_1],
        ];
        let f = |t: f64| if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
        let [x, y, z] = times(&to_xyz, linear);
        let [x, y, z] = [f(x / 0.95047), f(y), f(z / 1.08883)];
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// 2.3 units are just seen side by side; six times that is told apart across a picture.
    #[test]
    fn nobody_takes_one_material_for_another() {
        for (kind, matrix) in &SEEN {
            let seen = MATERIALS.map(|ink| lab(times(matrix, linear(ink.fill)).map(|part| part.clamp(0.0, 1.0))));
            for i in 0..seen.len() {
                for j in 0..i {
                    let apart = (0..3).map(|k| (seen[i][k] - seen[j][k]).powi(2)).sum::<f64>().sqrt();
                    let [a, b] = [i, j].map(|k| MATERIALS[k].fill);
                    assert!(apart > 15.0, "{a} and {b} are {apart:.1} apart with {kind}");
                }
            }
        }
    }

    /// WCAG 2.2 asks for a contrast of 4.5 of text.
    #[test]
    fn letters_can_be_read() {
        let luminance = |colour: &str| {
            let [r, g, b] = linear(colour);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for Ink { fill, text, .. } in MATERIALS {
            let [a, b] = [luminance(fill), luminance(text)];
            let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
            assert!(contrast >= 4.5, "{text} on {fill}: {contrast:.2}");
        }
    }

    #[test]
    fn letters_go_on_where_colours_come_again() {
        let letters: String = (0..10).map(|place| ink(place).letter).collect();
        assert_eq!(letters, "HABCDEFGIJ");
        assert_eq!(ink(8).fill, MATERIALS[1].fill);
        for (place, known) in MATERIALS.iter().enumerate() {
            assert_eq!(ink(place), *known);
        }
    }
}
