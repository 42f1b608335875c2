// The words of an OpenFOAM file: dictionaries, and lists in text or binary, plain or gzipped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "postproc/importers/buffer.h"
#include "postproc/importers/byte_stream.h"

namespace underbody::postproc {

/// Reads forward; every failure is an InputError with file and byte.
class FoamInput {
public:
    /// Opens `path`, or `path` + ".gz" when that is what there is, and reads the header.
    explicit FoamInput(const std::filesystem::path& path);
    /// Is one of both there?
    static bool exists(const std::filesystem::path& path);

    /// "volScalarField", "faceCompactList", ...; "" without a header.
    [[nodiscard]] const std::string& class_name() const { return class_; }

    /// Lists of one repeated value may be this long.
    void allow_repeated(std::uint64_t count) { most_repeated_ = count; }

    /// A word, a quoted text without its quotes, or one of (){}[]; and "" at the end. Comments are passed over.
    std::string token();
    /// Was the last token a quoted text? As a keyword it is a pattern then.
    [[nodiscard]] bool was_quoted() const { return quoted_; }
    void expect(const std::string& wanted);
    bool accept(char c);
    /// Does a word come next, no number and no bracket?
    bool at_letter();
    double number();
    std::uint64_t count();

    /// "List<scalar>" before a list, which OpenFOAM leaves out where the list is empty: "nonuniform 0()".
    void skip_list_type();
    /// What follows a word like "#include": its file is not read.
    void skip_directive() { token(); }

    /// "3 (0 1 2)", "3{0}", or the same in binary.
    Buffer<std::uint32_t> labels();
    /// A list of scalars, or of vectors and tensors in brackets: `components` numbers each.
    Buffer<double> reals(std::size_t components);
    /// "3(4(0 1 2 3) 3(0 1 2) ...)": corners of faces one after the other, with one more offset than faces.
    void faces(Buffer<std::uint32_t>& offsets, Buffer<std::uint32_t>& nodes);

    /// One value: "5" or "(1 0 0)".
    std::vector<double> value(std::size_t components);
    /// The rest of an entry after its key: up to its ';' or the end of its block.
    void skip_entry();

    /// How many numbers "List<vector>" or "volVectorField" have a place; 0: no such type.
    static std::size_t components_of(const std::string& type);

    [[nodiscard]] core::Place place() const { return in_.place(); }
    [[noreturn]] void fail(const std::string& what) const;

private:
    void read_header();
    int next();
    std::uint32_t label();
    void check_repeated(std::uint64_t count) const;
    void check_room(std::uint64_t count, std::uint64_t bytes) const;
    void raw_labels(std::uint32_t* out, std::uint64_t count);
    void raw_reals(double* out, std::uint64_t count);
    void skip_list(std::size_t components, bool whole_numbers);

    ByteStream in_;
    std::string class_;
    bool quoted_ = false;
    bool binary_ = false;
    bool swapped_ = false;
    std::size_t label_bytes_ = 4;
    std::size_t scalar_bytes_ = 8;
    std::uint64_t most_repeated_ = 0;
};

}  // namespace underbody::postproc
