//! Images of a few texels in the bytes of a file, exactly.

/// An image in the form of Radiance, rows from the top, of numbers that are multiples of 1/256 below 1, or powers of two: these are exact.
pub(super) fn radiance_hdr(width: usize, texels: &[[f64; 3]]) -> Vec<u8> {
    let height = texels.len() / width;
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for texel in texels {
        let most = texel.iter().copied().fold(0.0, f64::max);
        // A common exponent e, so that each channel is its byte times 2^(e − 136).
        let mut exponent = 128_i32;
        while most * 256.0 >= 256.0 * f64::from(exponent - 128).exp2() {
            exponent += 1;
        }
        let channel = |value: f64| (value * f64::from(136 - exponent).exp2()).round() as u8;
        bytes.extend(texel.map(channel));
        bytes.push(exponent as u8);
    }
    bytes
}

/// The same in grey.
pub(super) fn grey_hdr(width: usize, texels: &[f64]) -> Vec<u8> {
    radiance_hdr(width, &texels.iter().map(|&value| [value; 3]).collect::<Vec<_>>())
}

/// A PNG file of one row of texels: red, green, blue and alpha, eight bits each.
pub(super) fn rgba_png(texels: &[[u8; 4]]) -> Vec<u8> {
    png(6, texels.len(), texels.as_flattened())
}

/// A PNG file of one row of grey texels of eight bits.
pub(super) fn grey_png(values: &[u8]) -> Vec<u8> {
    png(0, values.len(), values)
}

/// One row of texels of a colour type, in a block that is stored, not compressed.
fn png(colour_type: u8, width: usize, texels: &[u8]) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        !bytes.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
        })
    };
    let row: Vec<u8> = [&[0], texels].concat();
    let (low, high) = row.iter().fold((1_u32, 0_u32), |(low, high), byte| {
        let low = (low + u32::from(*byte)) % 65521;
        (low, (high + low) % 65521)
    });
    let length = row.len() as u16;
    let data = [
        &[0x78, 0x01, 1][..],
        &length.to_le_bytes(),
        &(!length).to_le_bytes(),
        &row,
        &(high << 16 | low).to_be_bytes(),
    ]
    .concat();
    let header = [&(width as u32).to_be_bytes()[..], &[0, 0, 0, 1, 8, colour_type, 0, 0, 0]].concat();
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, bytes) in [(b"IHDR", header), (b"IDAT", data), (b"IEND", Vec::new())] {
        let chunk = [&name[..], &bytes].concat();
        file.extend((bytes.len() as u32).to_be_bytes());
        file.extend(&chunk);
        file.extend(crc(&chunk).to_be_bytes());
    }
    file
}
