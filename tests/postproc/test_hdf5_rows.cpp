// Numbers of HDF5 data sets: every way to store them gives the same, as far as the numbers can be told.
#include <gmock/gmock.h>
#include <hdf5.h>

#include <fstream>
#include <functional>
#include <numeric>

#include "core/error.h"
#include "core/file.h"
#include "postproc/importers/hdf5/hdf5_rows.h"

namespace underbody {

using postproc::Hdf5File;
using postproc::Hdf5Rows;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

/// How a data set is stored.
struct Way {
    std::string name;
    std::vector<hsize_t> chunk;  ///< none: in one piece
    bool shuffled = false;
    bool deflated = false;
    bool summed = false;       ///< with a check sum
    hsize_t user_block = 0;    ///< bytes of somebody else before the file
    bool cut = false;          ///< the last chunk has no more rows than the data set, as Fluent Meshing writes it
    bool edges_plain = false;  ///< chunks that reach beyond the data set are not packed
};

/// Replaces the last chunk of a list by one that ends with the list: another data set of just these rows lends its
/// bytes.
void cut_last_chunk(hid_t file, hid_t set, hid_t properties, hid_t type, hsize_t count, hsize_t chunk,
                    const std::vector<double>& values) {
    const hsize_t first = (count - 1) / chunk * chunk;
    const hsize_t rest = count - first;
    const hid_t own = H5Pcopy(properties);
    H5Pset_chunk(own, 1, &rest);
    const hid_t space = H5Screate_simple(1, &rest, nullptr);
    const hid_t lender = H5Dcreate2(file, "lender", type, space, H5P_DEFAULT, own, H5P_DEFAULT);
    H5Dwrite(lender, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data() + first);
    H5Dflush(lender);
    const hsize_t start = 0;
    hsize_t size = 0;
    ASSERT_GE(H5Dget_chunk_storage_size(lender, &start, &size), 0);
    std::vector<unsigned char> bytes(size);
    std::uint32_t mask = 0;
    ASSERT_GE(H5Dread_chunk(lender, H5P_DEFAULT, &start, &mask, bytes.data()), 0);
    ASSERT_GE(H5Dwrite_chunk(set, H5P_DEFAULT, mask, &first, bytes.size(), bytes.data()), 0);
    H5Dclose(lender);
    H5Sclose(space);
    H5Pclose(own);
}

void write(const fs::path& path, const Way& way, hid_t type, std::vector<hsize_t> size,
           const std::vector<double>& values) {
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_userblock(creation, way.user_block);
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT);
    H5Pclose(creation);
    const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    if (!way.chunk.empty()) {
        H5Pset_chunk(properties, static_cast<int>(size.size()), way.chunk.data());
    }
    if (way.shuffled) {
        H5Pset_shuffle(properties);
    }
    if (way.deflated) {
        H5Pset_deflate(properties, 4);
    }
    if (way.summed) {
        H5Pset_fletcher32(properties);
    }
    if (way.edges_plain) {
        H5Pset_chunk_opts(properties, H5D_CHUNK_DONT_FILTER_PARTIAL_CHUNKS);
    }
    const hid_t set = H5Dcreate2(file, "values", type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (way.cut && size.size() == 1 && size[0] % way.chunk[0] != 0) {
        H5Dflush(set);
        cut_last_chunk(file, set, properties, type, size[0], way.chunk[0], values);
    }
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
    H5Fclose(file);
}

std::vector<Way> ways(std::vector<hsize_t> chunk) {
    return {{"in one piece", {}},
            {"in chunks", chunk},
            {"deflated", chunk, false, true},
            {"shuffled", chunk, true, true},
            {"check sums", chunk, false, true, true},
            {"shuffled only", chunk, true},
            {"behind a user block", {}, false, false, false, 1024},
            {"deflated behind a user block", chunk, false, true, false, 512},
            {"deflated, cut", chunk, false, true, false, 0, true},
            {"shuffled, cut", chunk, true, true, false, 0, true},
            {"shuffled only, cut", chunk, true, false, false, 0, true},
            {"check sums, cut", chunk, false, true, true, 0, true},
            {"in chunks, cut", chunk, false, false, false, 0, true},
            {"deflated but for the edge", chunk, true, true, false, 0, false, true}};
}

std::vector<double> counted(std::size_t count, double first = 0) {
    std::vector<double> values(count);
    std::iota(values.begin(), values.end(), first);
    return values;
}

}  // namespace

TEST(Hdf5Rows, SharesOfAListAreTheSameHoweverItIsStored) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "values.h5";
    constexpr std::size_t count = 200001;  // more than one window of a chunk
    for (const hsize_t chunk : {hsize_t{97}, hsize_t{65536}, hsize_t{150000}, hsize_t{count}}) {
        for (const auto& way : ways({chunk})) {
            if (chunk == 97 && (way.summed || way.user_block > 0 || (way.cut && way.shuffled))) {
                continue;  // the same for many chunks, and slow
            }
            SCOPED_TRACE(way.name + ", chunks of " + std::to_string(chunk));
            write(path, way, H5T_STD_U32LE, {count}, counted(count));
            const Hdf5File file(path);
            Hdf5Rows rows(file);
            std::vector<std::uint32_t> a(3), b(120000), none(1, 77), end(1);
            std::vector<double> all(count);
            rows.add("/values", 65535, 3, a.data());
            rows.add("/values", 40000, b.size(), b.data());  // overlaps the first
            rows.add("/values", 10, 0, none.data());
            rows.add("/values", count - 1, 1, end.data());
            rows.add("/values", 0, count, all.data());
            rows.read(core::Progress::none());
            EXPECT_THAT(a, ::testing::ElementsAre(65535, 65536, 65537));
            for (std::size_t i = 0; i < b.size(); ++i) {
                ASSERT_EQ(b[i], 40000 + i);
            }
            EXPECT_EQ(none[0], 77);
            EXPECT_EQ(end[0], count - 1);
            EXPECT_EQ(all, counted(count));

            std::size_t seen = 0;
            postproc::each_row(file, "/values", core::Progress::none(),
                               [&](const std::uint32_t* numbers, std::size_t some) {
                                   for (std::size_t i = 0; i < some; ++i) {
                                       EXPECT_EQ(numbers[i], seen + i);
                                   }
                                   seen += some;
                                   return seen < 100000;
                               });
            EXPECT_GE(seen, 100000);
            if (chunk == 65536 && way.name == "deflated") {
                EXPECT_EQ(seen, 2 * chunk);  // not inflated: the rest
            }
        }
    }
}

TEST(Hdf5Rows, TablesWhoseChunksAreNarrowerAreTheSame) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "values.h5";
    const std::vector<double> values = counted(50 * 5, 0.25);
    for (const auto& chunk : std::vector<std::vector<hsize_t>>{{8, 5}, {50, 5}, {9, 2}, {1, 1}, {50, 3}}) {
        for (const auto& way : ways(chunk)) {
            SCOPED_TRACE(way.name + ", chunks of " + std::to_string(chunk[0]) + " x " + std::to_string(chunk[1]));
            write(path, way, H5T_IEEE_F64LE, {50, 5}, values);
            const Hdf5File file(path);
            Hdf5Rows rows(file);
            std::vector<double> all(values.size()), middle(30 * 5);
            rows.add("/values", 0, 50, all.data());
            rows.add("/values", 11, 30, middle.data());
            rows.read(core::Progress::none());
            EXPECT_EQ(all, values);
            EXPECT_TRUE(std::equal(middle.begin(), middle.end(), values.begin() + 11 * 5));
            std::vector<double> streamed;
            postproc::each_row(file, "/values", core::Progress::none(), [&](const double* numbers, std::size_t some) {
                streamed.insert(streamed.end(), numbers, numbers + some * 5);
                return true;
            });
            EXPECT_EQ(streamed, values);
        }
    }
}

TEST(Hdf5Rows, EveryTypeOfNumberGivesTheSameAsTheLibrary) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "values.h5";
    const std::vector<double> values = {
        0,  1, -1, 127, -128, 32767, -32768, 2147483647, -2147483648.0, 4294967295.0, 1099511627776.0, -1099511627776.0,
        0.5};
    const hid_t types[] = {H5T_STD_I8LE,  H5T_STD_U8LE,   H5T_STD_I16LE,  H5T_STD_U16LE,  H5T_STD_I32LE,
                           H5T_STD_U32LE, H5T_STD_I64LE,  H5T_STD_U64LE,  H5T_STD_I16BE,  H5T_STD_I32BE,
                           H5T_STD_I64BE, H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_IEEE_F32BE, H5T_IEEE_F64BE};
    for (const hid_t type : types) {
        const bool whole = H5Tget_class(type) == H5T_INTEGER;
        std::vector<double> as_library, as_reals;
        std::vector<std::uint32_t> ids_of_library, ids;
        for (const auto& way : ways({4})) {
            SCOPED_TRACE(way.name + ", type of " + std::to_string(H5Tget_size(type)) + " bytes");
            write(path, way, type, {values.size()}, values);
            const Hdf5File file(path);
            Hdf5Rows rows(file);
            as_reals.assign(values.size(), -7);
            rows.add("/values", 0, values.size(), as_reals.data());
            rows.read(core::Progress::none());
            if (whole) {
                ids.assign(values.size(), 7);
                rows.add("/values", 0, values.size(), ids.data());
                rows.read(core::Progress::none());
            }
            if (way.chunk.empty()) {
                as_library = as_reals;
                ids_of_library = ids;
            }
            EXPECT_EQ(as_reals, as_library);
            EXPECT_EQ(ids, ids_of_library);
        }
        EXPECT_EQ(as_library[3], 127);
    }
}

TEST(Hdf5Rows, DamagedChunksAndWrongRowsAreRefused) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "values.h5";
    constexpr std::size_t count = 100000;
    for (const bool shuffled : {false, true}) {
        write(path, {"", {count / 2 + 100}, shuffled, true, false}, H5T_STD_I32LE, {count}, counted(count));
        std::vector<std::uint32_t> out(count);
        {
            const Hdf5File file(path);
            Hdf5Rows rows(file);
            rows.add("/values", 1, count, out.data());
            EXPECT_THROW(rows.read(core::Progress::none()), core::InputError);
            rows.add("/nothing", 0, 1, out.data());
            EXPECT_THROW(rows.read(core::Progress::none()), core::InputError);
        }
        std::string bytes = core::read_file(path);
        // In the middle of what is deflated, and at its end, where only the check sum tells.
        for (const std::size_t at : {bytes.size() / 4, bytes.size() * 3 / 4}) {
            std::string changed = bytes;
            for (std::size_t i = 0; i < 64; ++i) {
                changed[at + i] = static_cast<char>(changed[at + i] ^ 0x5a);
            }
            std::ofstream(path, std::ios::binary) << changed;
            const Hdf5File file(path);
            Hdf5Rows rows(file);
            rows.add("/values", 0, count, out.data());
            try {
                rows.read(core::Progress::none());
                ADD_FAILURE() << "damage at " << at << " was not noticed";
            } catch (const core::InputError& error) {
                EXPECT_THAT(error.what(), HasSubstr("/values"));
            }
        }
    }
}

std::string refusal(const fs::path& path, std::size_t count) {
    const Hdf5File file(path);
    Hdf5Rows rows(file);
    std::vector<double> out(count);
    rows.add("/values", 0, count, out.data());
    try {
        rows.read(core::Progress::none());
    } catch (const core::InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Hdf5Rows, AChangedByteIsFoundByTheCheckSum) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "values.h5";
    for (const std::size_t count : {std::size_t{1001}, std::size_t{1000}}) {
        write(path, {"", {count}, false, false, true}, H5T_STD_U8LE, {count}, std::vector<double>(count, 85));
        EXPECT_EQ(refusal(path, count), "");
        std::string bytes = core::read_file(path);
        bytes[bytes.find("UUUUUUUU") + 500] = 'V';
        std::ofstream(path, std::ios::binary) << bytes;
        EXPECT_THAT(refusal(path, count), HasSubstr("check sum of row 0"));
    }
}

TEST(Hdf5Rows, ChunksThatOnlyTheLibraryCouldUnpackAreRefused) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "values.h5";
    constexpr hsize_t count = 64;
    const auto made = [&](hid_t type, const std::function<void(hid_t)>& pack, hsize_t written) {
        const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
        const hid_t space = H5Screate_simple(1, &count, nullptr);
        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
        const hsize_t chunk = 16;
        H5Pset_chunk(properties, 1, &chunk);
        pack(properties);
        const hid_t set = H5Dcreate2(file, "values", type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
        const hsize_t from = 0;
        H5Sselect_hyperslab(space, H5S_SELECT_SET, &from, nullptr, &written, nullptr);
        const hid_t memory = H5Screate_simple(1, &written, nullptr);
        H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, counted(count).data());
        H5Sclose(memory);
        H5Dclose(set);
        H5Pclose(properties);
        H5Sclose(space);
        H5Fclose(file);
        return refusal(path, count);
    };
    EXPECT_EQ(made(
                  H5T_STD_I32LE, [](hid_t) {}, count),
              "");
    EXPECT_THAT(made(
                    H5T_STD_I32LE, [](hid_t) {}, 32),
                HasSubstr("rows 32 to 48 were never written"));
    EXPECT_THAT(made(
                    H5T_STD_I32LE, [](hid_t p) { H5Pset_nbit(p); }, count),
                HasSubstr("h5repack"));
    EXPECT_THAT(made(
                    H5T_STD_I32LE, [](hid_t p) { H5Pset_deflate(p, 1), H5Pset_shuffle(p); }, count),
                HasSubstr("packed in another way"));
    const hid_t odd = H5Tcopy(H5T_STD_I32LE);
    H5Tset_precision(odd, 24);
    EXPECT_THAT(made(
                    odd, [](hid_t) {}, count),
                HasSubstr("4 bytes are of no kind that is read"));
    H5Tclose(odd);
}

TEST(Hdf5File, StringsAreTheSameHoweverTheyAreStored) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "names.h5";
    const std::vector<std::string> names = {"hull", "", "inlet;outlet", "a longer name than the others have"};
    constexpr std::size_t width = 40;
    const hsize_t count = names.size();
    for (const bool variable : {false, true}) {
        for (const hsize_t chunk : {hsize_t{0}, hsize_t{3}, hsize_t{4}}) {
            for (const bool deflated : {false, true}) {
                if ((deflated && chunk == 0) || (variable && chunk > 0)) {
                    continue;  // what is variable is refused in chunks
                }
                SCOPED_TRACE(std::to_string(variable) + " " + std::to_string(chunk) + " " + std::to_string(deflated));
                const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
                const hid_t type = H5Tcopy(H5T_C_S1);
                H5Tset_size(type, variable ? H5T_VARIABLE : width);
                const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
                if (chunk > 0) {
                    H5Pset_chunk(properties, 1, &chunk);
                }
                if (deflated) {
                    H5Pset_deflate(properties, 4);
                }
                const hid_t space = H5Screate_simple(1, &count, nullptr);
                const hid_t set = H5Dcreate2(file, "names", type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
                std::string fixed(width * names.size(), '\0');
                std::vector<const char*> pointers;
                for (std::size_t i = 0; i < names.size(); ++i) {
                    fixed.replace(i * width, names[i].size(), names[i]);
                    pointers.push_back(names[i].c_str());
                }
                H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                         variable ? static_cast<const void*>(pointers.data()) : fixed.data());
                H5Dclose(set);
                H5Sclose(space);
                H5Pclose(properties);
                H5Tclose(type);
                H5Fclose(file);
                EXPECT_EQ(Hdf5File(path).texts("/names"), names);
            }
        }
    }
}

TEST(Hdf5Rows, ListsThatWereNeverWrittenAreRefusedBeforeMemoryIsTaken) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "values.h5";
    const hid_t made = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hsize_t size = hsize_t{1} << 40;
    const hsize_t chunk = 1000;
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 1);
    H5Dclose(H5Dcreate2(made, "values", H5T_STD_I32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Pclose(properties);
    H5Sclose(space);
    H5Fclose(made);
    const Hdf5File file(path);
    EXPECT_EQ(file.shape("/values"), std::vector<std::uint64_t>{size});
    EXPECT_THROW((void)file.backed_shape("/values"), core::InputError);
    EXPECT_THROW((void)file.numbers("/values"), core::InputError);
}

}  // namespace underbody
