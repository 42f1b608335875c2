#pragma once
enum Rotation { ROTATION_PITCH_270 = 25 };
struct Vector3f {
    float x = 0, y = 0, z = 0;
};
class RangeFinder {
public:
    bool has_data_orient(enum Rotation orientation) const;
    float distance_orient(enum Rotation orientation) const;  // m
};
namespace AP {
RangeFinder* rangefinder();
}
class Sub {
public:
    void userhook_init();
    void userhook_50Hz();

private:
    struct {
        bool get_velocity_NED(Vector3f& velocity) const;
    } ahrs;
    struct {
        void set_throttle(float throttle);
    } motors;
};
