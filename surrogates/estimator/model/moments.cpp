#include "surrogates/estimator/model/moments.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define UNDERBODY_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define UNDERBODY_WIDE_VECTORS
#endif

namespace underbody::estimator {

namespace {

constexpr std::size_t most_channels = 64;
constexpr std::size_t tile = 256;          // samples that stay in the first-level cache
constexpr std::size_t chunk = 256 * tile;  // samples of one parallel block: fixes the order of summation

using Lane = double __attribute__((vector_size(32)));

// products[i][j] += sum over a tile of x_i x_j (j <= i); columns of `x` are `tile` long, zero-padded, 32-byte aligned.
UNDERBODY_WIDE_VECTORS void add_products(const double* x, std::size_t channels, double* products) {
    constexpr std::size_t lanes = tile / 4;
    for (std::size_t i = 0; i < channels; ++i) {
        const auto* a = reinterpret_cast<const Lane*>(x + i * tile);
        std::size_t j = 0;
        for (; j + 3 <= i; j += 4) {  // four products share the loads of a
            const auto* b0 = reinterpret_cast<const Lane*>(x + j * tile);
            const auto* b1 = b0 + lanes;
            const auto* b2 = b1 + lanes;
            const auto* b3 = b2 + lanes;
            Lane s0{}, s1{}, s2{}, s3{};
            for (std::size_t k = 0; k < lanes; ++k) {
                s0 += a[k] * b0[k];
                s1 += a[k] * b1[k];
                s2 += a[k] * b2[k];
                s3 += a[k] * b3[k];
            }
            double* p = products + i * channels + j;
            p[0] += (s0[0] + s0[1]) + (s0[2] + s0[3]);
            p[1] += (s1[0] + s1[1]) + (s1[2] + s1[3]);
            p[2] += (s2[0] + s2[1]) + (s2[2] + s2[3]);
            p[3] += (s3[0] + s3[1]) + (s3[2] + s3[3]);
        }
        for (; j <= i; ++j) {
            const auto* b = reinterpret_cast<const Lane*>(x + j * tile);
            Lane s{}, t{};
            for (std::size_t k = 0; k < lanes; k += 2) {
                s += a[k] * b[k];
                t += a[k + 1] * b[k + 1];
            }
            s += t;
            products[i * channels + j] += (s[0] + s[1]) + (s[2] + s[3]);
        }
    }
}

// Copies a tile of samples, less the shift, into columns; adds the sums, widens the ranges. The rest of the columns is
// zero, which lies within the range of what is shifted by a mean.
UNDERBODY_WIDE_VECTORS void load_tile(const SampleView& samples, std::size_t first, std::size_t count,
                                      const double* shift, double* columns, double* sums, double* lowest,
                                      double* highest) {
    if (samples.sample_stride == 1) {
        for (std::size_t c = 0; c < samples.channels; ++c) {
            const double* from = samples.data + c * samples.channel_stride + first;
            for (std::size_t k = 0; k < count; ++k) {
                columns[c * tile + k] = from[k] - shift[c];
            }
        }
    } else {
        for (std::size_t k = 0; k < count; ++k) {
            const double* from = samples.data + (first + k) * samples.sample_stride;
            for (std::size_t c = 0; c < samples.channels; ++c) {
                columns[c * tile + k] = from[c * samples.channel_stride] - shift[c];
            }
        }
    }
    for (std::size_t c = 0; c < samples.channels; ++c) {
        std::fill(columns + c * tile + count, columns + (c + 1) * tile, 0.0);
        const auto* x = reinterpret_cast<const Lane*>(columns + c * tile);
        Lane s{}, t{}, low{}, high{};
        for (std::size_t k = 0; k < tile / 4; k += 2) {
            s += x[k];
            t += x[k + 1];
            low = x[k] < low ? x[k] : low;
            low = x[k + 1] < low ? x[k + 1] : low;
            high = x[k] > high ? x[k] : high;
            high = x[k + 1] > high ? x[k + 1] : high;
        }
        s += t;
        sums[c] += (s[0] + s[1]) + (s[2] + s[3]);
        lowest[c] = std::min({lowest[c], low[0], low[1], low[2], low[3]});
        highest[c] = std::max({highest[c], high[0], high[1], high[2], high[3]});
    }
}

Moments moments_of_chunk(const SampleView& samples, std::size_t begin, std::size_t end) {
    const std::size_t n = samples.channels;
    alignas(32) static thread_local std::array<double, most_channels * tile> columns;
    std::array<double, most_channels> shift{}, sums{}, lowest{}, highest{};
    std::vector<double> products(n * n, 0.0);
    // The mean of the first tile is near enough to the chunk's to leave no cancellation.
    const std::size_t head = std::min(tile, end - begin);
    load_tile(samples, begin, head, shift.data(), columns.data(), sums.data(), lowest.data(), highest.data());
    for (std::size_t c = 0; c < n; ++c) {
        shift[c] = sums[c] / static_cast<double>(head);
        sums[c] = lowest[c] = highest[c] = 0;
    }
    for (std::size_t first = begin; first < end; first += tile) {
        load_tile(samples, first, std::min(tile, end - first), shift.data(), columns.data(), sums.data(), lowest.data(),
                  highest.data());
        add_products(columns.data(), n, products.data());
    }
    Moments m;
    m.count = end - begin;
    const auto count = static_cast<double>(m.count);
    m.mean.resize(n);
    m.covariance = Matrix(n, n);
    for (std::size_t i = 0; i < n; ++i) {
        m.lowest.push_back(shift[i] + lowest[i]);
        m.highest.push_back(shift[i] + highest[i]);
        m.mean[i] = shift[i] + sums[i] / count;
        for (std::size_t j = 0; j <= i; ++j) {
            const double c = (products[i * n + j] - sums[i] * sums[j] / count) / count;
            m.covariance(i, j) = c;
            m.covariance(j, i) = c;
        }
    }
    return m;
}

[[noreturn]] void refuse_value(const SampleView& samples, const std::vector<std::string>& names, std::size_t offset) {
    for (std::size_t i = 0; i < samples.count; ++i) {
        for (std::size_t c = 0; c < samples.channels; ++c) {
            const double v = samples.data[c * samples.channel_stride + i * samples.sample_stride];
            if (!std::isfinite(v)) {
                throw core::InputError("range",
                                       "sample " + std::to_string(offset + i + 1) + " of channel " +
                                           (c < names.size() ? "'" + names[c] + "'" : std::to_string(c + 1)) + " is " +
                                           (std::isnan(v) ? "not a number" : "infinite"),
                                       {}, "leave out or mend the samples with missing values first");
            }
        }
    }
    throw core::InputError("range", "the samples are too large: their squares overflow");
}

bool finite(const Moments& m) {
    return m.covariance.finite() &&
           std::all_of(m.mean.begin(), m.mean.end(), [](double v) { return std::isfinite(v); });
}

Moments moments_from(const SampleView& samples, const std::vector<std::string>& names, std::size_t offset,
                     core::Progress& progress) {
    std::vector<Moments> parts((samples.count + chunk - 1) / chunk);
    core::parallel_blocks(
        samples.count, chunk,
        [&](std::size_t begin, std::size_t end) { parts[begin / chunk] = moments_of_chunk(samples, begin, end); },
        progress);
    Moments all;
    for (const Moments& part : parts) {
        all.merge(part);
    }
    if (!finite(all)) {
        refuse_value(samples, names, offset);
    }
    return all;
}

}  // namespace

void Moments::merge(const Moments& other) {
    if (other.count == 0) {
        return;
    }
    if (count == 0) {
        *this = other;
        return;
    }
    const auto a = static_cast<double>(count), b = static_cast<double>(other.count);
    const double total = a + b;
    Vector delta(mean.size());
    for (std::size_t i = 0; i < mean.size(); ++i) {
        delta[i] = other.mean[i] - mean[i];
    }
    for (std::size_t i = 0; i < mean.size(); ++i) {
        for (std::size_t j = 0; j < mean.size(); ++j) {
            covariance(i, j) =
                (a * covariance(i, j) + b * other.covariance(i, j) + a * b / total * delta[i] * delta[j]) / total;
        }
        mean[i] += b / total * delta[i];
    }
    for (std::size_t i = 0; i < lowest.size() && i < other.lowest.size(); ++i) {
        lowest[i] = std::min(lowest[i], other.lowest[i]);
        highest[i] = std::max(highest[i], other.highest[i]);
    }
    count += other.count;
}

Moments moments(const SampleView& samples, const std::vector<std::string>& names, core::Progress& progress) {
    if (samples.channels == 0 || samples.count == 0) {
        throw core::InputError("empty", "there are no samples");
    }
    if (samples.channels > most_channels) {
        throw core::InputError("range", "at most 64 channels, not " + std::to_string(samples.channels));
    }
    return moments_from(samples, names, 0, progress);
}

namespace {

struct NpyHeader {
    std::size_t offset = 0;  ///< first byte of the data
    std::size_t rows = 0, columns = 0;
};

std::size_t number_in(const std::string& text, std::size_t& at) {
    while (at < text.size() && (text[at] < '0' || text[at] > '9')) {
        ++at;
    }
    std::size_t value = 0;
    const auto result = std::from_chars(text.data() + at, text.data() + text.size(), value);
    at = static_cast<std::size_t>(result.ptr - text.data());
    return result.ec == std::errc() ? value : 0;
}

NpyHeader read_npy_header(std::ifstream& in, const std::string& name, std::uintmax_t size) {
    std::array<char, 12> head{};
    in.read(head.data(), 10);
    const auto refuse = [&](const std::string& what, std::int64_t byte) {
        throw core::InputError("parse", what, {name, {}, {}, byte},
                               "a NumPy .npy file of float64 in C order is wanted: numpy.save(FILE, array)");
    };
    if (!in || std::memcmp(head.data(), "\x93NUMPY", 6) != 0) {
        refuse("not a NumPy .npy file", 0);
    }
    std::size_t length = static_cast<unsigned char>(head[8]) + 256U * static_cast<unsigned char>(head[9]);
    std::size_t start = 10;
    if (head[6] >= 2) {
        in.read(head.data() + 10, 2);
        length += 65536U * static_cast<unsigned char>(head[10]) + 16777216U * static_cast<unsigned char>(head[11]);
        start = 12;
    }
    if (!in || length > size || length > (1U << 20U)) {
        refuse("the header is cut off", 8);
    }
    std::string text(length, ' ');
    in.read(text.data(), static_cast<std::streamsize>(length));
    if (!in) {
        refuse("the header is cut off", static_cast<std::int64_t>(start));
    }
    if (text.find("'<f8'") == std::string::npos) {
        refuse("the values are not float64", static_cast<std::int64_t>(start));
    }
    if (text.find("'fortran_order': True") != std::string::npos) {
        refuse("the array is in Fortran order", static_cast<std::int64_t>(start));
    }
    std::size_t at = text.find("'shape'");
    if (at == std::string::npos) {
        refuse("the header states no shape", static_cast<std::int64_t>(start));
    }
    NpyHeader header{start + length, 0, 0};
    header.rows = number_in(text, at);
    header.columns = number_in(text, at);
    if (header.rows == 0 || header.columns == 0) {
        refuse("the array needs two dimensions", static_cast<std::int64_t>(start));
    }
    if (header.rows > size / header.columns || header.rows * header.columns > size / sizeof(double) ||
        header.offset + header.rows * header.columns * sizeof(double) > size) {
        refuse("the file ends before its " + std::to_string(header.rows) + " x " + std::to_string(header.columns) +
                   " values do",
               static_cast<std::int64_t>(size));
    }
    return header;
}

}  // namespace

Moments moments_of_file(const std::filesystem::path& npy, const std::vector<std::string>& names,
                        core::Progress& progress) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(npy, error);
    std::ifstream in(npy, std::ios::binary);
    if (error || !in) {
        throw core::InputError("missing", "cannot read the file", {npy.string(), {}, {}, {}});
    }
    const NpyHeader header = read_npy_header(in, npy.string(), size);
    const bool rows_are_samples = header.rows >= header.columns;
    const std::size_t channels = std::min(header.rows, header.columns);
    const std::size_t count = std::max(header.rows, header.columns);
    if (channels > most_channels) {
        throw core::InputError("range", "at most 64 channels, not " + std::to_string(channels),
                               {npy.string(), {}, {}, {}});
    }
    const std::size_t piece = 4 * chunk;  // a whole number of chunks: the same sums as in memory
    std::vector<double> buffer(std::min(piece, count) * channels);
    Moments all;
    for (std::size_t first = 0; first < count; first += piece) {
        progress.check();
        progress.report(static_cast<double>(first) / static_cast<double>(count), "covariance");
        const std::size_t n = std::min(piece, count - first);
        const auto bytes_of = [](std::size_t values) { return static_cast<std::streamsize>(values * sizeof(double)); };
        if (rows_are_samples) {
            in.seekg(static_cast<std::streamoff>(header.offset + first * channels * sizeof(double)));
            in.read(reinterpret_cast<char*>(buffer.data()), bytes_of(n * channels));
        } else {
            for (std::size_t c = 0; c < channels; ++c) {
                in.seekg(static_cast<std::streamoff>(header.offset + (c * count + first) * sizeof(double)));
                in.read(reinterpret_cast<char*>(buffer.data() + c * n), bytes_of(n));
            }
        }
        if (!in) {
            throw core::SystemError("read", "reading stopped in the middle", {npy.string(), {}, {}, {}});
        }
        const SampleView view = rows_are_samples ? SampleView::samples_in_rows(buffer.data(), n, channels)
                                                 : SampleView::channels_in_rows(buffer.data(), channels, n);
        all.merge(moments_from(view, names, first, progress));
    }
    return all;
}

void write_npy(const std::filesystem::path& npy, const double* samples_in_rows, std::size_t count,
               std::size_t channels) {
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(count) + ", " +
                         std::to_string(channels) + "), }";
    while ((10 + header.size() + 1) % 64 != 0) {
        header += ' ';
    }
    header += '\n';
    core::PendingFile file(npy);
    std::ofstream out(file.path(), std::ios::binary);
    const char start[10] = {'\x93',
                            'N',
                            'U',
                            'M',
                            'P',
                            'Y',
                            1,
                            0,
                            static_cast<char>(header.size() & 255U),
                            static_cast<char>(header.size() >> 8U)};
    out.write(start, sizeof start);
    out << header;
    out.write(reinterpret_cast<const char*>(samples_in_rows),
              static_cast<std::streamsize>(count * channels * sizeof(double)));
    out.close();
    if (!out) {
        throw core::SystemError("write", "cannot write the file", {npy.string(), {}, {}, {}});
    }
    file.commit();
}

}  // namespace underbody::estimator
