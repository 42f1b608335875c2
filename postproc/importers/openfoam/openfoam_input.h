// The words of an OpenFOAM file: dictionaries, and lists in text or binary, plain or gzipped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "postproc/importers/byte_stream.h"
#include "postproc/importers/mesh/buffer.h"
#include "postproc/importers/openfoam/openfoam_macros.h"

namespace underbody::postproc {

/// Reads forward; every failure is an InputError with file and byte.
class FoamInput {
public:
    /// Opens `path`, or `path` + ".gz" when that is what there is, and reads the header.
    explicit FoamInput(const std::filesystem::path& path);
    FoamInput(const FoamInput&) = delete;
    FoamInput& operator=(const FoamInput&) = delete;
    /// Is one of both there?
    static bool exists(const std::filesystem::path& path);

    /// "volScalarField", "faceCompactList", ...; "" without a header.
    [[nodiscard]] const std::string& class_name() const { return class_; }

    /// From here on "$name" is replaced by the entry of that name, and "#include" by the text of that file of the case.
    /// What cannot be known without OpenFOAM ("#calc", "#codeStream", a name that is not there) is an InputError of the
    /// kind `kind_unread` where a number is wanted, and a word elsewhere.
    void expand_macros(const std::filesystem::path& case_folder);
    static constexpr const char* kind_unread = "unread";
    /// Names of entries are of this dictionary until `leave`.
    void enter(const std::string& dictionary) { entries_.enter(dictionary); }
    void leave() { entries_.leave(); }
    void define(const std::string& key, const std::string& text);

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
    /// What follows a word like "#include": its file is not read. Throws the InputError of give_up where the word
    /// begins or ends a branch ("#ifeq").
    void skip_directive(const std::string& word);

    /// "3 (0 1 2)", "3{0}", or the same in binary.
    Buffer<std::uint32_t> labels();
    /// A list of scalars, or of vectors and tensors in brackets: `components` numbers each.
    Buffer<double> reals(std::size_t components);
    /// "3(4(0 1 2 3) 3(0 1 2) ...)": corners of faces one after the other, with one more offset than faces.
    void faces(Buffer<std::uint32_t>& offsets, Buffer<std::uint32_t>& nodes);

    /// "[0 2 -2 0 0 0 0];", "[kinematicPressure];", "[];": exponents of kg, m, s, K, mol, A, cd.
    std::vector<double> dimensions();
    /// One value: "5" or "(1 0 0)".
    std::vector<double> value(std::size_t components);
    /// The rest of an entry after its key: up to its ';' or the end of its block. `text` gets its words (the first 64
    /// kB).
    void skip_entry(std::string* text = nullptr);
    /// Up to the ';' behind a value that was begun.
    void skip_to_end_of_value();
    /// The same, and what it states is kept for macros.
    void take_entry(const std::string& key);

    /// How many numbers "List<vector>" or "volVectorField" have a place; 0: no such type.
    static std::size_t components_of(const std::string& type);

    /// Of the file itself, also within what it includes.
    [[nodiscard]] core::Place place() const { return file_.place(); }
    [[noreturn]] void fail(const std::string& what) const;
    /// Throws the InputError of what is sound, but cannot be read here.
    [[noreturn]] void give_up(const std::string& what) const;
    [[noreturn]] void give_up_at_macro(const std::string& word) const;

private:
    void read_header();
    int next();
    std::uint32_t label();
    void check_repeated(std::uint64_t count) const;
    void check_room(std::uint64_t count, std::uint64_t bytes) const;
    void raw_labels(std::uint32_t* out, std::uint64_t count);
    void raw_reals(double* out, std::uint64_t count);
    void skip_list(std::size_t components, bool whole_numbers);
    /// Text that is read before the file goes on, and the folder that its own includes start from.
    struct Pushed {
        Pushed(std::string&& read, std::filesystem::path from, const std::string& name)
            : text(std::move(read)), folder(std::move(from)), stream(text, name) {}
        std::string text;
        std::filesystem::path folder;
        ByteStream stream;
    };
    void push(std::string text, const std::filesystem::path& folder);
    void pop();
    bool substitute();
    bool include();
    std::string code();
    bool take_rest(const std::string& key, std::string& text, int depth);
    [[nodiscard]] std::filesystem::path folder() const;
    /// Are lists stored as bytes at this place? What is pushed is text.
    [[nodiscard]] bool binary() const { return binary_ && pushed_.empty(); }

    ByteStream file_;
    ByteStream* in_ = nullptr;  ///< the file, or the last of what is pushed
    std::vector<std::unique_ptr<Pushed>> pushed_;
    std::size_t pushed_bytes_ = 0;
    FoamEntries entries_;
    std::filesystem::path case_folder_;
    bool expanding_ = false;
    std::string class_;
    bool quoted_ = false;
    bool binary_ = false;
    bool swapped_ = false;
    std::size_t label_bytes_ = 4;
    std::size_t scalar_bytes_ = 8;
    std::uint64_t most_repeated_ = 0;
};

}  // namespace underbody::postproc
