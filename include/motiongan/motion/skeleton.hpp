// Joints, skeletons, clips as stored in BVH files, and motions as the library processes them.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace motiongan::motion {

/// x, y, z.
using Vec3 = std::array<double, 3>;

/// Unit quaternion, scalar first.
struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
  friend bool operator==(const Quat&, const Quat&) = default;
};

/// One value of a BVH frame. Rotations are in degrees, positions in the file's length unit.
enum class Channel { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

/// Whether the channel is an angle, not a position.
inline bool is_rotation(Channel c) { return c >= Channel::x_rotation; }

/// 0, 1 or 2 for x, y or z.
inline std::size_t axis(Channel c) { return static_cast<std::size_t>(c) % 3; }

/// A joint of a skeleton.
struct Joint {
  std::string name;
  int parent = -1;  ///< index into Skeleton::joints, always smaller than the joint's own; -1 for the root
  Vec3 offset{};    ///< from the parent, in the parent's frame, in the file's unit
  std::vector<Channel> channels;  ///< in file order; rotations apply left to right: R = R1 * R2 * R3
  std::optional<Vec3> end_site;   ///< offset of the End Site, if any

  friend bool operator==(const Joint&, const Joint&) = default;
};

/// The most joints of a skeleton that comes from a plain list of names; joints are looked up by name, one by
/// one.
inline constexpr std::size_t most_joints = 10000;

/// A tree of joints, parents before children, in the order of the BVH file.
struct Skeleton {
  std::vector<Joint> joints;

  std::size_t size() const { return joints.size(); }

  /// Number of values per frame in a BVH file of this skeleton.
  std::size_t channel_count() const {
    std::size_t n = 0;
    for (const Joint& j : joints) n += j.channels.size();
    return n;
  }

  /// Index of the joint called `name`, or -1.
  int find(std::string_view name) const {
    for (std::size_t i = 0; i < joints.size(); ++i)
      if (joints[i].name == name) return static_cast<int>(i);
    return -1;
  }

  friend bool operator==(const Skeleton&, const Skeleton&) = default;
};

/// A BVH file: a skeleton and its channels, frame by frame, exactly as written.
struct Clip {
  std::string id;  ///< file name without folder and extension
  Skeleton skeleton;
  double frame_time = 0;  ///< seconds
  std::size_t frames = 0;
  std::vector<double> channels;    ///< [frames, skeleton.channel_count()], degrees and length units
  std::vector<std::string> notes;  ///< what the reader corrected or ignored, one sentence each

  /// Frames per second.
  double rate() const { return 1.0 / frame_time; }
};

/// A motion independent of channel order: every joint's local rotation and position. All motion in the
/// library, whether read, generated or procedural, takes this form.
struct Motion {
  Skeleton skeleton;
  double rate = 0;  ///< frames per second
  std::size_t frames = 0;
  std::vector<Quat> rotations;  ///< [frames, joints], each joint's rotation relative to its parent
  std::vector<Vec3> positions;  ///< [frames, joints], each joint's origin in its parent's frame (its offset,
                                ///< unless it has position channels)

  /// The rotation of a joint relative to its parent.
  /// \{
  const Quat& rotation(std::size_t frame, std::size_t joint) const {
    return rotations[frame * skeleton.size() + joint];
  }
  Quat& rotation(std::size_t frame, std::size_t joint) { return rotations[frame * skeleton.size() + joint]; }
  /// \}
  const Vec3& position(std::size_t frame, std::size_t joint) const {
    return positions[frame * skeleton.size() + joint];
  }
  Vec3& position(std::size_t frame, std::size_t joint) { return positions[frame * skeleton.size() + joint]; }
};

}  // namespace motiongan::motion
