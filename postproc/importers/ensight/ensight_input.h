// The three codings of EnSight Gold files behind one face: text, C binary, Fortran binary, either byte order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/importers/byte_stream.h"
#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

enum class EnsightCoding { text, c_binary, fortran_binary };

/// Words between blanks; what stands in quotation marks is one.
std::vector<std::string> ensight_words(std::string_view text);

class EnsightInput {
public:
    /// `coding` and `swapped` are those of the geometry; a geometry finds them out itself.
    EnsightInput(const std::filesystem::path& path, EnsightCoding coding, bool swapped);

    /// The coding of a geometry file, by its first bytes.
    static EnsightCoding coding_of(const std::filesystem::path& path);

    [[nodiscard]] bool at_end();
    /// One line (80 characters in binary), without blanks at its ends.
    std::string line();
    /// Does the next line begin with that word? It is not taken.
    [[nodiscard]] bool line_begins_with(std::string_view word);
    /// As line(), but a blank line of text counts: names and descriptions may be empty.
    std::string line_as_it_is();
    /// Behind the mark that begins step `step` (from 0) of a file that holds several.
    void to_step(int step);
    std::int64_t integer();
    void integers(std::vector<std::int64_t>& out, std::uint64_t count);
    void reals(double* out, std::uint64_t count);
    /// `count` numbers of 4 bytes (2 in text) must fit into what is left.
    void check_room(std::uint64_t count, const std::string& what);
    /// A number of items; refused when negative or larger than the file can hold.
    std::uint64_t count(const std::string& what);
    /// The number of a part: the first one tells the byte order.
    std::int64_t part_number(bool first);

    [[nodiscard]] bool swapped() const { return swapped_; }
    [[noreturn]] void fail(const std::string& what) const;

private:
    std::string rest_of_line();
    void read_record(void* out, std::uint64_t bytes);
    /// A record of 4 bytes each, in the byte order of this machine; C binary has none for nothing.
    Buffer<std::uint32_t> words(std::uint64_t count);
    std::string token();

    ByteStream in_;
    EnsightCoding coding_;
    bool swapped_;
    std::int64_t line_ = 0;
};

}  // namespace underbody::postproc
