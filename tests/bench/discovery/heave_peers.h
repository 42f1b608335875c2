// What others would do with the same heave runs, and the best that can be reached there.
#pragma once

#include <memory>

#include "tests/bench/discovery/peers.h"
#include "tests/bench/discovery/plants.h"

namespace underbody::bench {

/// One standard deviation of a gap reading of the heave plant, m.
inline constexpr double heave_noise = 2e-4;

/// The peers of peers.h on the residual force of the same smoother that `underbody residual` draws, one value a second,
/// each told the true noise; then their force goes into the declared model, and its error is that of discover():
/// windows of two seconds on the test runs.
class HeavePeers {
public:
    HeavePeers(const dynamics::Model& model, const Sample& sample);
    ~HeavePeers();
    HeavePeers(const HeavePeers&) = delete;
    HeavePeers& operator=(const HeavePeers&) = delete;

    /// Library: what each effect of the catalogue does to that force when it is small.
    [[nodiscard]] PeerAnswer sparse_regression() const;
    /// Over gap, velocity, time and input.
    [[nodiscard]] PeerAnswer polynomial() const;
    [[nodiscard]] PeerAnswer gaussian_process() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Error on the test runs of the true law: its numbers fitted with the catalogue's form where it has one, else (unknown
/// laws) the law itself as a fine table; with the true sensor noise. m.
double heave_best(const dynamics::Model& model, const Case& wanted, const Sample& sample);

}  // namespace underbody::bench
