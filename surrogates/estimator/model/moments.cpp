#include "surrogates/estimator/model/moments.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"

namespace underbody::estimator {

namespace {

constexpr std::size_t most_channels = 64;
constexpr std::size_t tile = 256;          // samples that stay in the first-level cache
constexpr std::size_t chunk = 256 * tile;  // samples of one parallel block: fixes the order of summation

Moments moments_of_chunk(const SampleView& samples, std::size_t begin, std::size_t end) {
    using Eigen::Dynamic;
    using Eigen::Index;
    const auto n = static_cast<Index>(samples.channels);
    const auto values = [&](std::size_t first) {
        const auto count = static_cast<Index>(std::min(tile, end - first));
        const Eigen::Stride<Dynamic, Dynamic> strides(static_cast<Index>(samples.channel_stride),
                                                      static_cast<Index>(samples.sample_stride));
        return Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Dynamic, Dynamic>>(
            samples.data + first * samples.sample_stride, count, n, strides);
    };
    // The mean of the first tile is near enough to the chunk's to leave no cancellation; then zero lies in the range.
    const Eigen::RowVectorXd shift = values(begin).colwise().mean();
    Eigen::RowVectorXd sums = Eigen::RowVectorXd::Zero(n), lowest = sums, highest = sums;
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n), x;
    for (std::size_t first = begin; first < end; first += tile) {
        x = values(first).rowwise() - shift;
        sums += x.colwise().sum();
        lowest = lowest.cwiseMin(x.colwise().minCoeff());
        highest = highest.cwiseMax(x.colwise().maxCoeff());
        products.selfadjointView<Eigen::Lower>().rankUpdate(x.transpose());
    }
    Moments m;
    m.count = end - begin;
    const auto count = static_cast<double>(m.count);
    m.covariance = Matrix(samples.channels, samples.channels);
    for (Index i = 0; i < n; ++i) {
        m.lowest.push_back(shift[i] + lowest[i]);
        m.highest.push_back(shift[i] + highest[i]);
        m.mean.push_back(shift[i] + sums[i] / count);
        for (Index j = 0; j <= i; ++j) {
            const double c = (products(i, j) - sums[i] * sums[j] / count) / count;
            const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
            m.covariance(row, column) = m.covariance(column, row) = c;
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
