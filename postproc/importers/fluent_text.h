// The words of a legacy Fluent file: brackets, hexadecimal and decimal numbers, quoted strings, binary bodies.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/importers/buffer.h"
#include "postproc/importers/byte_stream.h"

namespace underbody::postproc {

/// Reads forward through a ByteStream; every failure is an InputError with file, byte and section.
class FluentText {
public:
    explicit FluentText(ByteStream& in) : in_(in) {}

    [[nodiscard]] ByteStream& stream() { return in_; }
    [[noreturn]] void fail(const std::string& what) const;
    void set_section(std::uint64_t index) { section_ = index; }

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
    /// "(10 interior int-FLUID 1)": the words in the brackets.
    std::vector<std::string> words();

    /// After an opening bracket: the text up to its closing one, which is taken too. Strings may hold brackets.
    /// At most `most` bytes are kept.
    std::string inside(std::size_t most);
    /// A comment may hold brackets that do not match; after "(0".
    std::string comment();

    /// `count` numbers in ASCII, after the opening bracket of a body.
    void reals(double* out, std::uint64_t count);

    /// The rest of the body of an ASCII section that holds numbers only, and its closing brackets.
    void skip_plain_body();
    void close_plain_body();
    /// "End of Binary Section 3010)" after a binary body.
    void close_binary_body(std::uint64_t index);
    /// Searches for that end: for sections whose length nobody told.
    void skip_binary_body(std::uint64_t index);

    /// Hexadecimal numbers without checks between them: the fast way through faces.
    std::uint32_t fast_hex();
    /// Makes sure that a face of this many numbers lies in the window.
    void look_ahead(std::size_t numbers_ahead) { in_.ensure(numbers_ahead * 20); }

private:
    /// Is the next word "(10 " or the like, or the end of the file?
    bool section_ahead();

    ByteStream& in_;
    std::uint64_t section_ = 0;
};

}  // namespace underbody::postproc
