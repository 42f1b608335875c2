#include "postproc/importers/hdf5/hdf5_file.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <set>

#include "core/error.h"
#include "core/inputs.h"
#include "core/text.h"
#include "postproc/importers/hdf5/hdf5_chunks.h"
#include "postproc/importers/hdf5/hdf5_handle.h"
#include "postproc/importers/hdf5/hdf5_numbers.h"
#include "postproc/importers/hdf5/hdf5_rows.h"
#include "postproc/importers/linked_files.h"
#include "postproc/importers/sandboxed_read.h"

namespace underbody::postproc {

namespace {

void quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

constexpr std::uint64_t largest_ratio = 1032;  // of deflate

/// The strings that stand in `raw`, as many bytes each as `type` has.
std::vector<std::string> fixed_strings(hid_t type, const std::vector<char>& raw) {
    const std::size_t width = H5Tget_size(type);
    std::vector<std::string> strings;
    for (std::size_t at = 0; width > 0 && at + width <= raw.size(); at += width) {
        const std::string_view part(raw.data() + at, width);
        strings.emplace_back(part.substr(0, part.find('\0')));
    }
    return strings;
}

/// Strings of variable length: `read` fills a list of pointers to memory that the library took and takes back.
template <typename Read>
std::vector<std::string> variable_strings(hid_t type, hid_t space, std::size_t count, Read&& read) {
    std::vector<char*> pointers(count, nullptr);
    const bool good = read(pointers.data()) >= 0;
    std::vector<std::string> strings;
    for (const char* pointer : pointers) {
        if (good) {
            strings.emplace_back(pointer != nullptr ? pointer : "");
        }
    }
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
    return strings;
}

/// The string of an attribute; nothing if it holds another number of them, something else, or cannot be read.
std::optional<std::string> string_of_attribute(hid_t attribute) {
    constexpr std::size_t longest = 1 << 16;
    const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
    const Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
    if (!type.good() || !space.good() || H5Tget_class(type.get()) != H5T_STRING ||
        H5Sget_simple_extent_npoints(space.get()) != 1) {
        return {};
    }
    std::vector<std::string> strings;
    if (H5Tis_variable_str(type.get()) > 0) {
        strings = variable_strings(type.get(), space.get(), 1,
                                   [&](char** out) { return H5Aread(attribute, type.get(), out); });
    } else if (H5Tget_size(type.get()) <= longest) {
        std::vector<char> raw(H5Tget_size(type.get()));
        if (H5Aread(attribute, type.get(), raw.data()) >= 0) {
            strings = fixed_strings(type.get(), raw);
        }
    }
    return strings.empty() ? std::nullopt : std::optional(strings.front());
}

bool in_chunks(hid_t set) {
    const Hdf5Handle plan(H5Dget_create_plist(set), H5Pclose);
    return plan.good() && H5Pget_layout(plan.get()) == H5D_CHUNKED;
}

/// The bytes of a list in chunks, `count` times the width of the type; nothing if they cannot be had.
std::optional<std::vector<char>> bytes_in_chunks(hid_t set, hid_t type, hid_t space, std::uint64_t file_bytes,
                                                 std::uint64_t count) {
    std::string refusal;
    const auto layout = layout_of_chunks(set, type, space, refusal);
    if (!layout || layout->lengths[1] != 1 || layout->lengths[0] != count) {
        return {};
    }
    std::vector<char> bytes;
    bool whole = true;
    Hdf5Chunk chunk;
    for (; whole && chunk.row < count; chunk.row += layout->chunk[0]) {
        const hsize_t end = std::min<hsize_t>(count, chunk.row + layout->chunk[0]);
        whole = load_chunk(set, *layout, file_bytes, chunk).empty() &&
                unpack(*layout, chunk, end, core::Progress::none(),
                       [&](hsize_t, hsize_t rows, const unsigned char* stored) {
                           bytes.insert(bytes.end(), stored, stored + rows * layout->width);
                           return true;
                       });
    }
    return whole ? std::optional(std::move(bytes)) : std::nullopt;
}

/// The strings of a dataset; nothing if it holds something else, more than a file of so many bytes can, or cannot be
/// read.
std::optional<std::vector<std::string>> strings_of_set(hid_t set, std::uint64_t file_bytes) {
    const Hdf5Handle type(H5Dget_type(set), H5Tclose);
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    const hssize_t size = space.good() ? H5Sget_simple_extent_npoints(space.get()) : 0;
    if (!type.good() || H5Tget_class(type.get()) != H5T_STRING || size < 0) {
        return {};
    }
    const auto count = static_cast<std::uint64_t>(size);
    const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(set), file_bytes);
    const std::size_t width = H5Tget_size(type.get());
    if (count > stored || width == 0 || width / largest_ratio > stored || width * count / largest_ratio > stored) {
        return {};
    }
    if (H5Tis_variable_str(type.get()) > 0) {
        hsize_t bytes = 0;
        // Out of chunks the library would take references without a look at the chunk's end.
        if (in_chunks(set) || H5Dvlen_get_buf_size(set, type.get(), space.get(), &bytes) < 0 || bytes > file_bytes) {
            return {};
        }
        auto strings = variable_strings(type.get(), space.get(), count, [&](char** out) {
            return H5Dread(set, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, out);
        });
        return strings.size() == count ? std::optional(std::move(strings)) : std::nullopt;
    }
    if (in_chunks(set)) {
        const auto bytes = bytes_in_chunks(set, type.get(), space.get(), file_bytes, count);
        return bytes ? std::optional(fixed_strings(type.get(), *bytes)) : std::nullopt;
    }
    if (width * count > stored) {
        return {};
    }
    std::vector<char> raw(width * count);
    if (count > 0 && H5Dread(set, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, raw.data()) < 0) {
        return {};
    }
    return fixed_strings(type.get(), raw);
}

herr_t read_attribute(hid_t object, const char* name, const H5A_info_t* info, void* /*unused*/) {
    constexpr std::size_t longest = 1 << 16;
    const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    if (!attribute.good() || info->data_size > longest) {
        return 0;
    }
    const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
    if (type.good() && H5Tget_class(type.get()) == H5T_STRING) {
        (void)string_of_attribute(attribute.get());
    } else if (type.good() && H5Tdetect_class(type.get(), H5T_VLEN) == 0) {
        std::vector<char> memory(2 * longest);
        H5Aread(attribute.get(), type.get(), memory.data());
    }
    return 0;
}

/// What was looked at, and how large the file is.
struct Looked {
    std::uint64_t bytes = 0;
    std::set<haddr_t> objects;  ///< links may go round
    std::string path;           ///< of the group that is looked at
    std::string report;         ///< paths, each with a '\0' behind it
};

void look_at_set(hid_t set, const Looked& looked) {
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    const Hdf5Handle type(H5Dget_type(set), H5Tclose);
    hsize_t chunks = 0;
    H5Dget_num_chunks(set, space.get(), &chunks);  // walks the index of the chunks
    if (H5Tget_class(type.get()) == H5T_STRING && H5Tis_variable_str(type.get()) > 0) {
        (void)strings_of_set(set, looked.bytes);
    }
}

constexpr char link_mark = '\1';  ///< before a name that is none of a path but of a file that a link leads to

void report_link(hid_t group, const char* name, std::size_t bytes, std::string& report) {
    std::vector<char> value(bytes);
    unsigned flags = 0;
    const char* file = nullptr;
    const char* object = nullptr;
    if (H5Lget_val(group, name, value.data(), bytes, H5P_DEFAULT) >= 0 &&
        H5Lunpack_elink_val(value.data(), bytes, &flags, &file, &object) >= 0) {
        report += link_mark + std::string(file) + '\0';
    }
}

herr_t look_at(hid_t group, const char* name, const H5L_info_t* link, void* looked) {
    auto& all = *static_cast<Looked*>(looked);
    if (link->type == H5L_TYPE_EXTERNAL) {
        report_link(group, name, link->u.val_size, all.report);
    }
    const Hdf5Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
    H5O_info_t info{};
    if (!object.good() || H5Oget_info(object.get(), &info) < 0) {
        return 0;  // what comes after it is looked at all the same
    }
    constexpr std::size_t longest = std::size_t{64} << 20;
    const std::size_t length = all.path.size();
    all.path += std::string("/") + name;
    const bool known = !all.objects.insert(info.addr).second;  // by another name
    if (!known) {
        H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, read_attribute, nullptr);
    }
    if (all.report.size() + all.path.size() < longest) {
        all.report += all.path + '\0';
    }
    if (known) {
        all.path.resize(length);
        return 0;
    }
    if (info.type == H5O_TYPE_DATASET) {
        look_at_set(object.get(), all);
    } else if (info.type == H5O_TYPE_GROUP) {
        H5Literate(object.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, look_at, looked);
    }
    all.path.resize(length);
    return 0;
}

/// Everything about the file but the numbers: what damage makes the library stumble over lies there. The paths of what
/// is good.
std::string look_through(const std::filesystem::path& path) {
    std::error_code error;
    Looked looked;
    looked.bytes = std::filesystem::file_size(path, error);
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (file.good()) {
        H5Literate(file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, look_at, &looked);
    }
    return looked.report;
}

using Paths = std::shared_ptr<const std::set<std::string>>;

/// The paths of what is in a file. It is looked through once, as long as it does not change; a case and its data take
/// turns.
Paths paths_in(const std::filesystem::path& path) {
    constexpr std::size_t remembered = 16;
    static std::mutex mutex;
    static std::vector<std::pair<std::string, Paths>> known;
    std::error_code error;
    const auto changed = std::filesystem::last_write_time(path, error);
    const std::string print = path.string() + " " + std::to_string(std::filesystem::file_size(path, error)) + " " +
                              std::to_string(changed.time_since_epoch().count());
    const std::lock_guard lock(mutex);
    for (const auto& [file, paths] : known) {
        if (file == print) {
            return paths;
        }
    }
    auto paths = std::make_shared<std::set<std::string>>();
    const std::string report = report_of_child(path, [&] { return look_through(path); });
    for (std::size_t at = 0; at < report.size();) {
        const std::size_t end = report.find('\0', at);
        paths->insert(paths->end(), report.substr(at, end - at));
        at = end + 1;
    }
    if (known.size() == remembered) {
        known.erase(known.begin());
    }
    known.emplace_back(print, paths);
    return paths;
}

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path) : name_(path.string()) {
    core::note_content(path);
    quiet();
    looked_at_ = paths_in(path);
    for (const auto& link : *looked_at_) {
        if (link.starts_with(link_mark)) {
            note_linked(path, link.substr(1));
        }
    }
    std::error_code error;
    bytes_ = std::filesystem::file_size(path, error);
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
    file_ = H5Fopen(name_.c_str(), H5F_ACC_RDONLY, access.get());
    if (file_ < 0) {
        throw core::InputError("format", "this is not a whole HDF5 file: it is cut short or damaged",
                               {name_, {}, {}, {}}, "copy the file again");
    }
}

Hdf5File::~Hdf5File() {
    if (file_ >= 0) {
        H5Fclose(file_);
    }
}

void Hdf5File::fail(const std::string& path, const std::string& what) const {
    throw core::InputError("format", path + ": " + what, {name_, {}, {}, {}}, "the file is damaged or incomplete");
}

bool Hdf5File::has(const std::string& path) const {
    return path == "/" || looked_at_->contains(path.ends_with('/') ? path.substr(0, path.size() - 1) : path);
}

std::vector<std::string> Hdf5File::children(const std::string& path) const {
    std::vector<std::string> names;
    const std::string before = path.ends_with('/') ? path : path + "/";
    for (auto at = looked_at_->lower_bound(before); at != looked_at_->end() && at->starts_with(before); ++at) {
        if (at->find('/', before.size()) == std::string::npos) {
            names.push_back(at->substr(before.size()));
        }
    }
    std::stable_sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
        const auto x = core::parse_integer(a);
        const auto y = core::parse_integer(b);
        return x && y ? *x < *y : a < b;
    });
    return names;
}

std::optional<std::int64_t> Hdf5File::attribute(const std::string& path, const std::string& name) const {
    if (!has(path) || H5Aexists_by_name(file_, path.c_str(), name.c_str(), H5P_DEFAULT) <= 0) {
        return {};
    }
    const Hdf5Handle attribute(H5Aopen_by_name(file_, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!attribute.good()) {
        return {};
    }
    const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
    const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
    std::int64_t value = 0;
    if (!space.good() || H5Sget_simple_extent_npoints(space.get()) != 1 || H5Tget_class(type.get()) != H5T_INTEGER ||
        conversion_from(type.get(), false) ==
            nullptr ||  // the library converts what has any number of bits, without a look at where they end
        H5Aread(attribute.get(), H5T_NATIVE_INT64, &value) < 0) {
        fail(path, "its attribute " + name + " is not one whole number");
    }
    return value;
}

std::optional<std::string> Hdf5File::text_attribute(const std::string& path, const std::string& name) const {
    if (!has(path) || H5Aexists_by_name(file_, path.c_str(), name.c_str(), H5P_DEFAULT) <= 0) {
        return {};
    }
    const Hdf5Handle attribute(H5Aopen_by_name(file_, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!attribute.good()) {
        return {};
    }
    return string_of_attribute(attribute.get());
}

std::vector<std::uint64_t> Hdf5File::shape(const std::string& path) const {
    if (!has(path)) {
        return {};
    }
    const Hdf5Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set.good()) {
        return {};
    }
    const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.get());
    if (rank < 1 || rank > 2) {
        return {};
    }
    hsize_t lengths[2] = {};
    H5Sget_simple_extent_dims(space.get(), lengths, nullptr);
    return {lengths, lengths + rank};
}

std::vector<std::uint64_t> Hdf5File::backed_shape(const std::string& path) const {
    const auto lengths = shape(path);
    if (!lengths.empty()) {
        const Hdf5Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
        (void)backed_size(set.get(), path);
    }
    return lengths;
}

std::uint64_t Hdf5File::backed_size(std::int64_t dataset, const std::string& path) const {
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
    const hssize_t count = space.good() ? H5Sget_simple_extent_npoints(space.get()) : -1;
    if (count < 0) {
        fail(path, "its size cannot be read");
    }
    const auto size = static_cast<std::uint64_t>(count);
    const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(dataset), bytes_);
    // What lies there as it is must be there in full: the library copies it without a look at the end.
    const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
    const bool packed = in_chunks(dataset);
    const std::uint64_t width = type.good() ? std::max<std::uint64_t>(1, H5Tget_size(type.get())) : 1;
    const std::uint64_t most = packed ? stored * largest_ratio : stored / width;
    if (size > most) {
        fail(path,
             "it claims " + std::to_string(size) + " values but has " + std::to_string(stored) + " bytes in the file");
    }
    return size;
}

Buffer<std::uint32_t> Hdf5File::numbers(const std::string& path) const {
    const auto lengths = backed_shape(path);
    if (lengths.size() != 1) {
        fail(path, lengths.empty() ? "there is no such data set" : "it is not one list");
    }
    Buffer<std::uint32_t> values(lengths[0]);
    Hdf5Rows rows(*this);
    rows.add(path, 0, lengths[0], values.data());
    rows.read(core::Progress::none());
    return values;
}

std::vector<std::string> Hdf5File::texts(const std::string& path) const {
    const Hdf5Handle set(has(path) ? H5Dopen2(file_, path.c_str(), H5P_DEFAULT) : -1, H5Dclose);
    if (!set.good()) {
        return {};
    }
    auto strings = strings_of_set(set.get(), bytes_);
    const Hdf5Handle type(H5Dget_type(set.get()), H5Tclose);
    if (!strings && type.good() && H5Tget_class(type.get()) == H5T_STRING) {
        const bool variable = in_chunks(set.get()) && H5Tis_variable_str(type.get()) > 0;
        fail(path, variable
                       ? "strings of variable length in chunks are not read (write the file anew: h5repack -l CONTI)"
                       : "its strings cannot be read");
    }
    return std::move(strings).value_or(std::vector<std::string>());
}

std::string Hdf5File::text(const std::string& path) const {
    const auto strings = texts(path);
    return std::accumulate(strings.begin(), strings.end(), std::string());
}

}  // namespace underbody::postproc
