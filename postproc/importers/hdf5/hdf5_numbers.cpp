#include "postproc/importers/hdf5/hdf5_numbers.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace underbody::postproc {

namespace {

template <typename Stored, typename Wanted>
Wanted as(Stored value) {
    if constexpr (std::is_same_v<Wanted, std::uint32_t> && sizeof(Stored) > sizeof(Wanted)) {
        constexpr Stored most = std::numeric_limits<Wanted>::max();
        return static_cast<Wanted>(std::clamp<Stored>(value, 0, most));
    } else {
        return static_cast<Wanted>(value);
    }
}

template <typename Stored, typename Wanted, std::endian order>
void convert(const unsigned char* stored, std::size_t count, void* out) {
    auto* wanted = static_cast<Wanted*>(out);
    for (std::size_t i = 0; i < count; ++i) {
        unsigned char bytes[sizeof(Stored)];
        std::memcpy(bytes, stored + i * sizeof(Stored), sizeof(Stored));
        if constexpr (order != std::endian::native) {
            std::reverse(bytes, bytes + sizeof(Stored));
        }
        Stored value;
        std::memcpy(&value, bytes, sizeof(Stored));
        wanted[i] = as<Stored, Wanted>(value);
    }
}

struct Known {
    hid_t little, big;
    Hdf5Convert from_little, from_big;
};

template <typename Stored, typename Wanted>
Known known(hid_t little, hid_t big) {
    return {little, big, convert<Stored, Wanted, std::endian::little>, convert<Stored, Wanted, std::endian::big>};
}

template <typename Wanted>
Hdf5Convert conversion_to(hid_t type) {
    const bool real = H5Tget_class(type) == H5T_FLOAT;
    if (real && std::is_integral_v<Wanted>) {
        return nullptr;
    }
    const Known all[] = {known<double, Wanted>(H5T_IEEE_F64LE, H5T_IEEE_F64BE),
                         known<std::uint32_t, Wanted>(H5T_STD_U32LE, H5T_STD_U32BE),
                         known<std::int32_t, Wanted>(H5T_STD_I32LE, H5T_STD_I32BE),
                         known<float, Wanted>(H5T_IEEE_F32LE, H5T_IEEE_F32BE),
                         known<std::int64_t, Wanted>(H5T_STD_I64LE, H5T_STD_I64BE),
                         known<std::uint64_t, Wanted>(H5T_STD_U64LE, H5T_STD_U64BE),
                         known<std::int16_t, Wanted>(H5T_STD_I16LE, H5T_STD_I16BE),
                         known<std::uint16_t, Wanted>(H5T_STD_U16LE, H5T_STD_U16BE),
                         known<std::int8_t, Wanted>(H5T_STD_I8LE, H5T_STD_I8BE),
                         known<std::uint8_t, Wanted>(H5T_STD_U8LE, H5T_STD_U8BE)};
    for (const auto& entry : all) {
        if (H5Tequal(entry.little, type) > 0) {
            return entry.from_little;
        }
        if (H5Tequal(entry.big, type) > 0) {
            return entry.from_big;
        }
    }
    return nullptr;
}

}  // namespace

Hdf5Convert conversion_from(hid_t type, bool whole) {
    return whole ? conversion_to<std::uint32_t>(type) : conversion_to<double>(type);
}

}  // namespace underbody::postproc
