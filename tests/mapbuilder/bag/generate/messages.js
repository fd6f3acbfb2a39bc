// SPDX-License-Identifier: Apache-2.0
// What the bags hold: the same messages in each, in the order of recording. Times are seconds and nanoseconds.

const T0 = 1700000000;

const time = (s, ns, ros1) => (ros1 ? { sec: T0 + s, nsec: ns } : { sec: T0 + s, nanosec: ns });

// 16 x 16 pixels each.
export const JPEG = Buffer.from(
  "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABQODxIPDRQSEBIXFRQYHjIhHhwcHj0sLiQySUBMS0dARkVQWnNiUFVtVkVGZIhlbXd7gYKBTmCNl4x9lnN+" +
    "gXz/wAALCAAQABABAREA/8QAFgABAQEAAAAAAAAAAAAAAAAAAQAC/8QAGxAAAgMBAQEAAAAAAAAAAAAAAQMAAiEREjH/2gAIAQEAAD8AvKmDnyBpde10" +
    "TRFG6MMDRiwOHs//2Q==", "base64");
export const PNG = Buffer.from(
  "iVBORw0KGgoAAAANSUhEUgAAABAAAAAQCAAAAAA6mKC9AAAADklEQVQI12NgGAWDEwAAAZAAAW98EBgAAAAASUVORK5CYII=", "base64");

const vector = (x, y, z) => ({ x, y, z });
const turn = (x, y, z, w) => ({ x, y, z, w });
const zeros = (count) => new Float64Array(count);

const RAW = {
  mono8: [4, 2, 1], mono16: [4, 2, 2], rgb8: [4, 2, 3], bgr8: [4, 2, 3], rgba8: [4, 2, 4], bgra8: [4, 2, 4],
  bayer_rggb8: [4, 4, 1], yuv422: [4, 2, 2], yuv422_yuy2: [4, 2, 2],
};

// Rows have two bytes of padding; byte i of the image is 7 i + 1.
function rawImage(header, encoding) {
  const [width, height, bytes] = RAW[encoding];
  const step = width * bytes + 2;
  const data = Uint8Array.from({ length: step * height }, (_, i) => (7 * i + 1) & 0xff);
  return { header, height, width, encoding, is_bigendian: 0, step, data };
}

export function allMessages(ros1) {
  let sequence = 0;
  const header = (s, ns, frame_id) => {
    const fields = { stamp: time(s, ns, ros1), frame_id };
    return ros1 ? { seq: sequence++, ...fields } : fields;
  };
  const transform = (s, ns, parent, child, translation, rotation) => ({
    header: header(s, ns, parent), child_frame_id: child, transform: { translation, rotation },
  });
  const pose = (x, y, qz, qw) => ({ position: vector(x, y, 0), orientation: turn(0, 0, qz, qw) });
  const withCovariance = (p) => ({ pose: p, covariance: zeros(36) });
  const twist = { twist: { linear: vector(0.5, 0, 0), angular: vector(0, 0, 0.1) }, covariance: zeros(36) };
  const list = [];
  const add = (topic, type, s, ns, message) => list.push({ topic, type, sec: T0 + s, nsec: ns, message });

  const half = Math.SQRT1_2;
  add("/tf_static", "tf2_msgs/TFMessage", 0, 0, {
    transforms: [
      transform(0, 0, "base_link", "camera_link", vector(0.2, 0, 0.3), turn(0, half, 0, half)),
      transform(0, 0, "camera_link", "camera_optical", vector(0, 0, 0), turn(-0.5, 0.5, -0.5, 0.5)),
      transform(0, 0, "base_link", "imu_link", vector(0, 0, 0.1), turn(0, 0, 1, 0)),
    ],
  });
  const d = [-0.1, 0.01, 0.001, -0.002, 0.003];
  const k = [20, 0, 7.5, 0, 21, 8.5, 0, 0, 1];
  const r = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const p = [19, 0, 7, 0, 0, 20, 8, 0, 0, 0, 1, 0];
  const roi = { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false };
  add("/camera/camera_info", "sensor_msgs/CameraInfo", 0, 1, {
    header: header(0, 1, "camera_optical"), height: 16, width: 16, distortion_model: "plumb_bob",
    ...(ros1 ? { D: d, K: k, R: r, P: p } : { d, k, r, p }), binning_x: 0, binning_y: 0, roi,
  });
  // The second image has an earlier stamp than the first; the format of the last one is not what its bytes are.
  [["jpeg", 200, JPEG], ["bgr8; jpeg compressed bgr8", 100, JPEG], ["jpeg", 300, PNG]].forEach(([format, ms, data], i) => {
    add("/camera/image_raw/compressed", "sensor_msgs/CompressedImage", 1, i,
      { header: header(0, ms * 1e6, "camera_optical"), format, data });
  });
  Object.keys(RAW).forEach((encoding, i) => {
    add("/raw", "sensor_msgs/Image", 2, i, rawImage(header(2, i, "camera_optical"), encoding));
  });
  for (let i = 0; i < 4; ++i) {
    add("/odom", "nav_msgs/Odometry", 3, i, {
      header: header(0, i * 100e6, "odom"), child_frame_id: "base_link", pose: withCovariance(pose(0.25 * i, 0.5, 0, 1)),
      twist,
    });
  }
  for (let i = 0; i < 2; ++i) {
    add("/imu/data", "sensor_msgs/Imu", 4, i, {
      header: header(0, i * 100e6, "imu_link"), orientation: turn(0, 0, 0, 1), orientation_covariance: zeros(9),
      angular_velocity: vector(0.1, 0.2, 0.3), angular_velocity_covariance: zeros(9),
      linear_acceleration: vector(1, 2, 9.75), linear_acceleration_covariance: zeros(9),
    });
  }
  add("/tf", "tf2_msgs/TFMessage", 5, 0, {
    transforms: [transform(0, 0, "/odom", "base_link", vector(1, 2, 0), turn(0, 0, half, half))],
  });
  add("/pose", "geometry_msgs/PoseStamped", 6, 0, { header: header(6, 0, "map"), pose: pose(3, 4, 1, 0) });
  add("/amcl_pose", "geometry_msgs/PoseWithCovarianceStamped", 6, 1,
    { header: header(6, 1, "map"), pose: withCovariance(pose(5, 6, 0, 1)) });
  add("/chatter", "std_msgs/String", 7, 0, { data: "hello" });
  return list;
}
