// Handles of the HDF5 library. Only for .cpp files: it brings the library's headers.
#pragma once

#include <hdf5.h>

namespace underbody::postproc {

/// Closes an HDF5 handle of any kind.
class Hdf5Handle {
public:
    explicit Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    ~Hdf5Handle() {
        if (id_ >= 0) {
            close_(id_);
        }
    }
    Hdf5Handle(const Hdf5Handle&) = delete;
    Hdf5Handle& operator=(const Hdf5Handle&) = delete;
    [[nodiscard]] hid_t get() const { return id_; }
    [[nodiscard]] bool good() const { return id_ >= 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

}  // namespace underbody::postproc
