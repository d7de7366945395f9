use super::*;

const SIZE: [u32; 2] = [40, 30];

/// A white frame with a box of a colour in it.
fn frame(colour: [u8; 3], at: [usize; 2]) -> Raster {
    let [r, g, b] = colour;
    let mut pixels = vec![[255; 4]; 40 * 30];
    for y in at[1]..at[1] + 5 {
        pixels[40 * y + at[0]..][..8].fill([r, g, b, 255]);
    }
    Raster { size: SIZE, pixels }
}

/// Frames of which the third equals the second.
fn frames() -> Vec<Raster> {
    let [red, blue] = [[200, 10, 20], [10, 20, 200]];
    vec![frame(red, [2, 3]), frame(red, [4, 3]), frame(red, [4, 3]), frame(blue, [30, 20]), frame(blue, [0, 25])]
}

fn written(format: FilmFormat, frames: &[Raster], playing: Playing, batch: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    let shape = (SIZE, frames.len());
    let mut film = Film::begin(&mut bytes, format, shape, playing, (frames, &[[255; 3]]), "a film").unwrap();
    frames.chunks(batch).for_each(|some| film.add(some.to_vec()).unwrap());
    film.finish().unwrap();
    bytes
}

const PLAYING: Playing = Playing { rate: 30.0, plays: None, hold: 1.5 };

/// The frames of a GIF as they are seen, the delay of each in hundredths, and how often it plays.
fn of_gif(bytes: &[u8]) -> (Vec<Vec<[u8; 3]>>, Vec<u16>, ::gif::Repeat) {
    let mut options = ::gif::DecodeOptions::new();
    options.set_color_output(::gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    let width = usize::from(decoder.width());
    let mut canvas = vec![[0; 3]; width * usize::from(decoder.height())];
    let (mut seen, mut delays) = (Vec::new(), Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays.push(frame.delay);
        for (i, pixel) in frame.buffer.as_chunks::<4>().0.iter().enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            if pixel[3] != 0 {
                let at = width * (y + usize::from(frame.top)) + x + usize::from(frame.left);
                canvas[at] = [pixel[0], pixel[1], pixel[2]];
            }
        }
        seen.push(canvas.clone());
    }
    (seen, delays, decoder.repeat())
}

fn opaque(frame: &Raster) -> Vec<[u8; 3]> {
    frame.pixels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect()
}

#[test]
fn a_gif_has_the_frames_that_were_added_and_only_what_changed_of_each() {
    let frames = frames();
    let bytes = written(FilmFormat::Gif, &frames, PLAYING, 2);
    let (seen, delays, repeat) = of_gif(&bytes);
    assert_eq!(seen, frames.iter().map(opaque).collect::<Vec<_>>());
    // A thirtieth of a second is 3.33 hundredths.
    assert_eq!(delays, [3, 4, 3, 3, 150]);
    assert_eq!(repeat, ::gif::Repeat::Infinite);
    for batch in [1, 3, 5] {
        assert!(written(FilmFormat::Gif, &frames, PLAYING, batch) == bytes, "{batch}");
    }
    let many: Vec<Raster> = frames.iter().cycle().take(500).cloned().collect();
    assert!(written(FilmFormat::Gif, &many, PLAYING, 7).len() < 500 * 200, "whole frames would be larger");
    let times = |plays| of_gif(&written(FilmFormat::Gif, &frames, Playing { plays, ..PLAYING }, 5)).2;
    // The format counts repetitions.
    assert_eq!([times(Some(1)), times(Some(3))], [::gif::Repeat::Finite(0), ::gif::Repeat::Finite(2)]);
}

#[test]
fn an_animated_png_has_every_pixel_of_every_frame() {
    let mut frames = frames();
    for transparent in [false, true] {
        if transparent {
            frames[1].pixels[7] = [3, 4, 5, 6];
        }
        let playing = Playing { plays: Some(3), ..PLAYING };
        let bytes = written(FilmFormat::Apng, &frames, playing, 2);
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let control = reader.info().animation_control().copied().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (5, 3));
        let step = if transparent { 4 } else { 3 };
        let mut canvas = vec![[255; 4]; 40 * 30];
        for (k, frame) in frames.iter().enumerate() {
            let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut buffer).unwrap();
            let part = *reader.info().frame_control().unwrap();
            for (i, pixel) in buffer.chunks(step).take((part.width * part.height) as usize).enumerate() {
                let (x, y) = (i as u32 % part.width + part.x_offset, i as u32 / part.width + part.y_offset);
                canvas[(40 * y + x) as usize][..step].copy_from_slice(pixel);
            }
            assert!(canvas == frame.pixels, "frame {k}");
            let seconds = f64::from(part.delay_num) / f64::from(part.delay_den);
            assert!((seconds - if k == 4 { 1.5 } else { 1.0 / 30.0 }).abs() < 1e-12, "{seconds}");
        }
        assert!(written(FilmFormat::Apng, &frames, playing, 5) == bytes);
    }
}

#[test]
fn a_film_with_fewer_frames_than_it_says_is_refused() {
    for format in [FilmFormat::Gif, FilmFormat::Apng] {
        let (mut bytes, frames) = (Vec::new(), frames());
        let mut film = Film::begin(&mut bytes, format, (SIZE, 3), PLAYING, (&frames, &[]), "").unwrap();
        film.add(frames[..2].to_vec()).unwrap();
        assert!(film.finish().is_err(), "{format:?}");
    }
}

#[test]
fn delays_add_up_to_the_time_of_the_film() {
    for rate in [0.1, 7.0, 12.5, 24.0, 29.97, 50.0] {
        let playing = Playing { rate, plays: None, hold: 0.0 };
        let total: u32 = (0..300).map(|k| u32::from(playing.hundredths(k, 300))).sum();
        assert_eq!(f64::from(total), (30_000.0 / rate).round());
        assert!((0..300).all(|k| playing.hundredths(k, 300) >= 2), "viewers slow shorter delays down");
    }
}

#[test]
fn flat_colours_stay_and_shades_of_more_than_a_palette_come_near() {
    // All shades between three colours.
    let mut pixels = Vec::new();
    for (from, to) in [([0, 0, 0], [255, 255, 255]), ([173, 78, 0], [219, 228, 236]), ([0, 43, 69], [255, 255, 255])] {
        for k in 0..=255_i32 {
            let mix = |a: i32, b: i32| (a + (b - a) * k / 255) as u8;
            pixels.push([mix(from[0], to[0]), mix(from[1], to[1]), mix(from[2], to[2]), 255]);
        }
    }
    let sample = Raster { size: [768, 1], pixels };
    let kept = [[173, 78, 0], [219, 228, 236], [1, 2, 3]];
    let colours = Colours::of(std::slice::from_ref(&sample), &kept);
    let table = colours.table();
    assert!(table.len() <= 256 && table[..3] == kept && usize::from(colours.clear()) == table.len() - 1);
    let indices = colours.indices(&sample.pixels);
    for (pixel, &index) in sample.pixels.iter().zip(&indices) {
        let near = table[usize::from(index)];
        assert_ne!(index, colours.clear());
        let off = (0..3).map(|k| near[k].abs_diff(pixel[k])).max().unwrap();
        assert!(off <= 6, "{pixel:?} became {near:?}");
    }
    assert_eq!(colours, Colours::of(&[sample], &kept));
    assert_eq!(Colours::of(&[], &[]).indices(&[[9; 4]]), [0]);
}

#[test]
fn the_part_that_changed_is_the_smallest_rectangle_around_it() {
    let before = [0; 20];
    let mut now = before;
    (now[7], now[13]) = (1, 1);
    assert_eq!(Part::changed(&before, &now, [5, 4]), Part { left: 2, top: 1, width: 2, height: 2 });
    assert_eq!(Part::changed(&before, &before, [5, 4]), Part { left: 0, top: 0, width: 1, height: 1 });
    let part = Part { left: 2, top: 1, width: 2, height: 2 };
    assert_eq!(part.indices(5).collect::<Vec<_>>(), [7, 8, 12, 13]);
}
