// The words of a legacy Fluent file: brackets, hexadecimal and decimal numbers, quoted strings, binary bodies.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/importers/byte_stream.h"
#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

/// Reads forward through a ByteStream; every failure is an InputError with file, byte and section.
class FluentText {
public:
    explicit FluentText(ByteStream& in) : in_(in) {}

    [[nodiscard]] ByteStream& stream() { return in_; }
    [[noreturn]] void fail(const std::string& what) const;
    void set_section(std::uint64_t index) { section_ = index; }

    /// The mark of UTF-8 that some editors put in front of a text.
    void skip_byte_order_mark();
    /// Blanks, line ends, and what editors leave at the end of a file.
    void skip_space();
    /// The next character that is not blank, not taken; -1 at the end.
    int next();
    void expect(char c);
    bool accept(char c);

    /// An unsigned number in hexadecimal or decimal digits.
    std::uint64_t number(int base);
    double real();
    /// "(1 a ff ...)": all the numbers in the brackets.
    std::vector<std::uint64_t> numbers(int base);
    /// The same of a section's header, which has at least `least` numbers.
    std::vector<std::uint64_t> header(int base, std::size_t least);
    /// Section 4, "(4 (60 0 0 1 2 4 4 4 8 8 8 4))": binary bodies that follow may be of the other byte order.
    void machine();
    /// "(10 interior int-FLUID 1)": the words in the brackets.
    std::vector<std::string> words();

    /// After an opening bracket: the text up to its closing one, which is taken too. Strings may hold brackets.
    /// At most `most` bytes are kept.
    std::string inside(std::size_t most);
    /// A comment may hold brackets that do not match; after "(0".
    std::string comment();

    /// `count` numbers in ASCII, after the opening bracket of a body. Long bodies are read by all threads.
    void reals(double* out, std::uint64_t count);
    /// `count` numbers of a binary body, of `size` bytes each (4 or 8), in the byte order that `machine` told.
    void binary_reals(double* out, std::uint64_t count, std::size_t size);
    /// `count` whole numbers of 4 bytes of a binary body.
    void binary_integers(std::uint32_t* out, std::size_t count);
    std::uint32_t binary_integer();

    /// The hexadecimal numbers from here to the body's closing bracket, or as many as the window holds, in lists that
    /// follow one another. False: the bracket was reached, and is not taken.
    bool hexadecimals(std::vector<Buffer<std::uint32_t>>& lists);

    /// The rest of the body of an ASCII section that holds numbers only, and its closing brackets.
    void skip_plain_body();
    void close_plain_body();
    /// "End of Binary Section 3010)" after a binary body.
    void close_binary_body(std::uint64_t index);
    /// Searches for that end: for sections whose length nobody told.
    void skip_binary_body(std::uint64_t index);
    /// Header and body of a section of unknown content, from behind its index on. A header may be all there is:
    /// "(2040 (1 8))".
    void skip_section(std::uint64_t index, bool binary);

    /// One hexadecimal number of 32 bits.
    std::uint32_t hexadecimal();

private:
    /// Is the next word "(10 " or the like, or the end of the file?
    bool section_ahead();
    /// The text from here on that holds whole numbers only, cut into pieces at blanks.
    std::vector<std::string_view> pieces(bool& bracket);
    /// A word among hexadecimal numbers that is none.
    [[noreturn]] void fail_at(const char* place);

    ByteStream& in_;
    std::uint64_t section_ = 0;
    bool swap_ = false;
    std::vector<Buffer<double>> parts_;  ///< of `reals`, kept for the next window
};

/// The hexadecimal numbers of a body, one after the other, parsed window by window.
class HexWords {
public:
    explicit HexWords(FluentText& text) : text_(text) {}
    std::uint32_t next() {
        if (at_ == end_) {
            advance();
        }
        return *at_++;
    }
    /// All numbers before the closing bracket must have been taken.
    void finish() const;

private:
    void advance();

    FluentText& text_;
    std::vector<Buffer<std::uint32_t>> lists_;
    std::size_t list_ = 0;
    const std::uint32_t* at_ = nullptr;
    const std::uint32_t* end_ = nullptr;
    bool more_ = true;
};

/// "3067 (4 times)" for sections that were passed over, with how often.
std::vector<std::string> listed_sections(const std::map<std::uint64_t, int>& skipped);

}  // namespace underbody::postproc
