// Means and covariances of many samples: one pass, blocked, mergeable, the same bytes whatever the number of threads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/estimator/model/matrix.h"

namespace underbody::estimator {

/// Samples somewhere in memory: value of channel c in sample i at data[c * channel_stride + i * sample_stride].
struct SampleView {
    const double* data = nullptr;
    std::size_t channels = 0;
    std::size_t count = 0;
    std::size_t channel_stride = 1;
    std::size_t sample_stride = 0;

    static SampleView samples_in_rows(const double* data, std::size_t count, std::size_t channels) {
        return {data, channels, count, 1, channels};
    }
    static SampleView channels_in_rows(const double* data, std::size_t channels, std::size_t count) {
        return {data, channels, count, count, 1};
    }
};

/// Population moments (division by the count).
struct Moments {
    std::size_t count = 0;
    Vector mean;
    Matrix covariance;
    Vector lowest, highest;  ///< of each channel, or further in towards the mean by round-off of the shift

    /// Exact joint moments of two sets (Chan, Golub and LeVeque 1983).
    void merge(const Moments& other);
};

/// Throws core::InputError naming channel and sample of the first value that is not finite (`names` for the message).
/// At most 64 channels.
Moments moments(const SampleView& samples, const std::vector<std::string>& names = {},
                core::Progress& progress = core::Progress::none());

/// The same from a NumPy .npy file of float64, shape (samples, channels) or (channels, samples) in C order, read in
/// pieces: memory does not grow with the file. The shorter side is the channels. Throws core::InputError with the byte.
Moments moments_of_file(const std::filesystem::path& npy, const std::vector<std::string>& names = {},
                        core::Progress& progress = core::Progress::none());

/// Writes samples in rows as .npy (whole file by rename).
void write_npy(const std::filesystem::path& npy, const double* samples_in_rows, std::size_t count,
               std::size_t channels);

}  // namespace underbody::estimator
