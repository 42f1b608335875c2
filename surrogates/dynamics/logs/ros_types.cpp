// Definitions of messages that vehicles log most, for bags that do not hold them (SQLite bags of Humble and before).
// From common_interfaces and rcl_interfaces of ROS 2 (Apache-2.0), without comments and constants.
#include <utility>

#include "surrogates/dynamics/logs/ros_message.h"

namespace underbody::dynamics {

const RosTypes& common_ros_types() {
    static const RosTypes all = [] {
        constexpr std::pair<const char*, const char*> definitions[] = {
            {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec"},
            {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec"},
            {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id"},
            {"std_msgs/Bool", "bool data"},
            {"std_msgs/Byte", "byte data"},
            {"std_msgs/Char", "char data"},
            {"std_msgs/Float32", "float32 data"},
            {"std_msgs/Float64", "float64 data"},
            {"std_msgs/Int8", "int8 data"},
            {"std_msgs/Int16", "int16 data"},
            {"std_msgs/Int32", "int32 data"},
            {"std_msgs/Int64", "int64 data"},
            {"std_msgs/UInt8", "uint8 data"},
            {"std_msgs/UInt16", "uint16 data"},
            {"std_msgs/UInt32", "uint32 data"},
            {"std_msgs/UInt64", "uint64 data"},
            {"std_msgs/String", "string data"},
            {"std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride"},
            {"std_msgs/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset"},
            {"std_msgs/Float32MultiArray", "MultiArrayLayout layout\nfloat32[] data"},
            {"std_msgs/Float64MultiArray", "MultiArrayLayout layout\nfloat64[] data"},
            {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z"},
            {"geometry_msgs/Vector3Stamped", "std_msgs/Header header\nVector3 vector"},
            {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z"},
            {"geometry_msgs/PointStamped", "std_msgs/Header header\nPoint point"},
            {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w"},
            {"geometry_msgs/Pose", "Point position\nQuaternion orientation"},
            {"geometry_msgs/PoseStamped", "std_msgs/Header header\nPose pose"},
            {"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance"},
            {"geometry_msgs/PoseWithCovarianceStamped", "std_msgs/Header header\nPoseWithCovariance pose"},
            {"geometry_msgs/Twist", "Vector3 linear\nVector3 angular"},
            {"geometry_msgs/TwistStamped", "std_msgs/Header header\nTwist twist"},
            {"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance"},
            {"geometry_msgs/Accel", "Vector3 linear\nVector3 angular"},
            {"geometry_msgs/AccelStamped", "std_msgs/Header header\nAccel accel"},
            {"geometry_msgs/Wrench", "Vector3 force\nVector3 torque"},
            {"geometry_msgs/WrenchStamped", "std_msgs/Header header\nWrench wrench"},
            {"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation"},
            {"geometry_msgs/TransformStamped", "std_msgs/Header header\nstring child_frame_id\nTransform transform"},
            {"nav_msgs/Odometry",
             "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
             "geometry_msgs/TwistWithCovariance twist"},
            {"sensor_msgs/Range",
             "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\n"
             "float32 max_range\nfloat32 range\nfloat32 variance"},
            {"sensor_msgs/Imu",
             "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
             "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
             "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance"},
            {"sensor_msgs/FluidPressure", "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance"},
            {"sensor_msgs/Temperature", "std_msgs/Header header\nfloat64 temperature\nfloat64 variance"},
            {"sensor_msgs/MagneticField",
             "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\nfloat64[9] magnetic_field_covariance"},
            {"sensor_msgs/JointState",
             "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort"},
            {"sensor_msgs/BatteryState",
             "std_msgs/Header header\nfloat32 voltage\nfloat32 temperature\nfloat32 current\nfloat32 charge\n"
             "float32 capacity\nfloat32 design_capacity\nfloat32 percentage\nuint8 power_supply_status\n"
             "uint8 power_supply_health\nuint8 power_supply_technology\nbool present\nfloat32[] cell_voltage\n"
             "float32[] cell_temperature\nstring location\nstring serial_number"},
            {"rcl_interfaces/Log",
             "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\nstring function\n"
             "uint32 line"},
        };
        RosTypes made;
        for (const auto& [type, text] : definitions) {
            add_ros_definition(made, type, text);
        }
        return made;
    }();
    return all;
}

}  // namespace underbody::dynamics
