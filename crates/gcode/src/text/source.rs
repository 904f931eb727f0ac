//! Lines of a program, read in chunks: memory stays the same for a file of any length, and a loop
//! can jump back.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::sync::Arc;

/// Bytes read at a time. Small enough for the second-level cache, large enough that the cost of a
/// read does not matter.
const CHUNK_BYTES: usize = 1 << 18;
/// Longest line. Real programs stay below 300 bytes (LinuxCNC stops at 255, comments included); a
/// longer line is a damaged file or no program, and must not fill the memory.
pub(crate) const MAX_LINE_BYTES: usize = 1 << 16;

/// A place to come back to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Mark {
    /// Byte offset of a line in the file.
    pub(crate) offset: u64,
    /// Number of the line before it.
    pub(crate) lines_before: u32,
}

/// One line, as a range of [`Source::bytes`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum SourceLine {
    /// A line without its end.
    Text(Range<usize>),
    /// A line of more than [`MAX_LINE_BYTES`], skipped; the range holds its beginning.
    TooLong(Range<usize>),
    /// End of the file.
    End,
}

/// A program as a sequence of lines.
#[derive(Debug)]
pub(crate) struct Source {
    /// Name as the user gave it.
    pub(crate) name: Arc<str>,
    file: Option<File>,
    buffer: Vec<u8>,
    /// File offset of `buffer[0]`.
    buffer_start: u64,
    /// Next unread byte of the buffer.
    next: usize,
    at_end: bool,
    /// Start of the line that `next_line` returned last.
    pub(crate) line_start: Mark,
    /// Number of that line, from 1.
    pub(crate) line: u32,
}

impl Source {
    /// Reads from a file that is open.
    pub(crate) fn from_file(name: Arc<str>, file: File) -> io::Result<Self> {
        let mut source = Self::new(name, Some(file), Vec::with_capacity(CHUNK_BYTES));
        source.refill()?;
        source.skip_byte_order_mark();
        Ok(source)
    }

    /// Reads from text in memory.
    pub(crate) fn from_text(name: Arc<str>, text: Vec<u8>) -> Self {
        let mut source = Self::new(name, None, text);
        source.at_end = true;
        source.skip_byte_order_mark();
        source
    }

    fn new(name: Arc<str>, file: Option<File>, buffer: Vec<u8>) -> Self {
        let line_start = Mark {
            offset: 0,
            lines_before: 0,
        };
        Self {
            name,
            file,
            buffer,
            buffer_start: 0,
            next: 0,
            at_end: false,
            line_start,
            line: 0,
        }
    }

    /// UTF-8 files from other systems begin with three bytes that are no text.
    fn skip_byte_order_mark(&mut self) {
        if self.buffer_start == 0 && self.next == 0 && self.buffer.starts_with(b"\xef\xbb\xbf") {
            self.next = 3;
        }
    }

    /// The first chunk, for a look at what kind of file this is.
    pub(crate) fn head(&self) -> &[u8] {
        &self.buffer
    }

    /// The bytes that [`SourceLine`] ranges refer to, valid until the next call of `next_line`.
    #[inline]
    pub(crate) fn bytes(&self, range: Range<usize>) -> &[u8] {
        &self.buffer[range]
    }

    /// The next line.
    #[inline]
    pub(crate) fn next_line(&mut self) -> io::Result<SourceLine> {
        loop {
            let unread = &self.buffer[self.next..];
            if let Some(length) = memchr::memchr(b'\n', unread) {
                let start = self.next;
                self.pass_line(length);
                let range = start..start + length;
                return Ok(if length > MAX_LINE_BYTES {
                    SourceLine::TooLong(head_of(range))
                } else {
                    SourceLine::Text(range)
                });
            }
            if self.at_end {
                return Ok(self.last_line());
            }
            if unread.len() > MAX_LINE_BYTES {
                return self.skip_long_line();
            }
            self.refill()?;
        }
    }

    /// Returns the text after the last line end.
    fn last_line(&mut self) -> SourceLine {
        let range = self.next..self.buffer.len();
        if range.is_empty() {
            return SourceLine::End;
        }
        self.begin_line();
        self.next = self.buffer.len();
        if range.len() > MAX_LINE_BYTES {
            SourceLine::TooLong(head_of(range))
        } else {
            SourceLine::Text(range)
        }
    }

    /// Returns the bytes already read from the file after the last line.
    #[inline]
    pub(crate) fn unread(&self) -> &[u8] {
        &self.buffer[self.next..]
    }

    /// Steps over the next line, which ends `length` bytes on.
    #[inline]
    pub(crate) fn pass_line(&mut self, length: usize) {
        self.begin_line();
        self.next += length + 1;
    }

    #[inline]
    fn begin_line(&mut self) {
        self.line_start = Mark {
            offset: self.buffer_start + self.next as u64,
            lines_before: self.line,
        };
        self.line = self.line.saturating_add(1);
    }

    /// Skips a line that does not fit; keeps its beginning for the message.
    #[cold]
    fn skip_long_line(&mut self) -> io::Result<SourceLine> {
        self.begin_line();
        let beginning: Vec<u8> = self.buffer[self.next..self.next + MAX_LINE_BYTES].to_vec();
        loop {
            if let Some(length) = memchr::memchr(b'\n', &self.buffer[self.next..]) {
                self.next += length + 1;
                break;
            }
            self.next = self.buffer.len();
            if self.at_end {
                break;
            }
            self.refill()?;
        }
        // The beginning goes in front of the unread rest; offsets in the file stay right.
        let length = beginning.len();
        let unread = self.buffer.split_off(self.next);
        let file_offset = self.buffer_start + self.next as u64;
        self.buffer = beginning;
        self.buffer.extend_from_slice(&unread);
        self.next = length;
        self.buffer_start = file_offset.saturating_sub(length as u64);
        Ok(SourceLine::TooLong(0..length))
    }

    /// Drops what has been read and reads the next chunk behind what has not.
    fn refill(&mut self) -> io::Result<()> {
        let Some(file) = &mut self.file else {
            self.at_end = true;
            return Ok(());
        };
        self.buffer.drain(..self.next);
        self.buffer_start += self.next as u64;
        self.next = 0;
        let read = file
            .take(CHUNK_BYTES as u64)
            .read_to_end(&mut self.buffer)?;
        self.at_end = read == 0;
        Ok(())
    }

    /// Goes on at `mark`.
    pub(crate) fn jump(&mut self, mark: Mark) -> io::Result<()> {
        self.line = mark.lines_before;
        let buffered = self.buffer_start..=self.buffer_start + self.buffer.len() as u64;
        if buffered.contains(&mark.offset) {
            self.next = usize::try_from(mark.offset - self.buffer_start).unwrap_or(0);
        } else if let Some(file) = &mut self.file {
            file.seek(SeekFrom::Start(mark.offset))?;
            self.buffer.clear();
            self.buffer_start = mark.offset;
            self.next = 0;
            self.at_end = false;
        }
        Ok(())
    }

    /// Takes a line of the file as the one that `next_line` returned last, for a message; leaves it
    /// where the file cannot be read.
    #[cold]
    pub(crate) fn find(&mut self, line: u32) {
        if self.rewind().is_ok() {
            while self.line < line
                && matches!(
                    self.next_line(),
                    Ok(SourceLine::Text(_) | SourceLine::TooLong(_))
                )
            {}
        }
    }

    /// Returns the start of the next line.
    pub(crate) fn here(&self) -> Mark {
        Mark {
            offset: self.buffer_start + self.next as u64,
            lines_before: self.line,
        }
    }

    /// Goes back to the first line.
    pub(crate) fn rewind(&mut self) -> io::Result<()> {
        self.jump(Mark {
            offset: 0,
            lines_before: 0,
        })?;
        if self.buffer.is_empty() && !self.at_end {
            self.refill()?;
        }
        self.skip_byte_order_mark();
        Ok(())
    }
}

fn head_of(range: Range<usize>) -> Range<usize> {
    range.start..range.end.min(range.start + MAX_LINE_BYTES)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn file_with(bytes: &[u8]) -> Source {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(bytes).unwrap();
        file.seek(SeekFrom::Start(0)).unwrap();
        Source::from_file("test".into(), file).unwrap()
    }

    fn lines(source: &mut Source) -> Vec<(u32, Vec<u8>)> {
        let mut all = Vec::new();
        while let SourceLine::Text(range) = source.next_line().unwrap() {
            all.push((source.line, source.bytes(range).to_vec()));
        }
        all
    }

    #[test]
    fn lines_across_chunks_are_whole() {
        let text: Vec<u8> = (0..60_000)
            .flat_map(|n| format!("N{n} X{n}\n").into_bytes())
            .collect();
        assert!(text.len() > 2 * CHUNK_BYTES);
        let from_file = lines(&mut file_with(&text));
        assert_eq!(
            from_file,
            lines(&mut Source::from_text("test".into(), text))
        );
        assert_eq!(from_file.len(), 60_000);
        assert_eq!(from_file[59_999], (60_000, b"N59999 X59999".to_vec()));
    }

    #[test]
    fn a_jump_returns_to_the_line() {
        let text: Vec<u8> = (0..60_000)
            .flat_map(|n| format!("N{n} X{n}\n").into_bytes())
            .collect();
        let mut source = file_with(&text);
        for _ in 0..10 {
            source.next_line().unwrap();
        }
        let mark = source.line_start;
        while source.next_line().unwrap() != SourceLine::End {}
        source.jump(mark).unwrap();
        let SourceLine::Text(range) = source.next_line().unwrap() else {
            panic!("no line")
        };
        assert_eq!((source.line, source.bytes(range)), (10, &b"N9 X9"[..]));
    }

    #[test]
    fn a_long_line_is_skipped_and_the_next_one_read() {
        let mut text = vec![b'x'; 3 * CHUNK_BYTES];
        text.extend_from_slice(b"\nG0\nG1");
        let mut source = file_with(&text);
        assert!(matches!(
            source.next_line().unwrap(),
            SourceLine::TooLong(_)
        ));
        assert_eq!(
            lines(&mut source),
            [(2, b"G0".to_vec()), (3, b"G1".to_vec())]
        );
    }

    #[test]
    fn a_byte_order_mark_is_no_text() {
        assert_eq!(
            lines(&mut file_with(b"\xef\xbb\xbfG0\n")),
            [(1, b"G0".to_vec())]
        );
    }
}
