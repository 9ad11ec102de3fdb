/* Bodyopt's runtime for programs in any language: a trained character is loaded once, and instances of it turn poses
 * into skin, on the CPU or on a Vulkan device.
 *
 * Units: metres, seconds, radians. Positions are in the world, vertices in the order of the character's file. Rotations
 * are quaternions x y z w.
 *
 * Errors: what can fail returns a bodyopt_result; bodyopt_last_error() says more. No exception leaves the library. A
 * call that failed wrote nothing, or some of the frames of its output, and all objects can be used on, but for
 * instances whose Vulkan device failed: these fail from then on, with BODYOPT_DEVICE.
 *
 * Versions: every structure begins with struct_size, which the caller sets to its sizeof. Later versions of the library
 * add fields at the end and take 0 in them for what was before; they are binary compatible as long as
 * BODYOPT_VERSION_MAJOR is the same. NAME_FIRST_SIZE beside a structure is its size in its first version (64 bit): no
 * smaller struct_size is taken, and none that is larger than the library's own. bodyopt_floats and
 * bodyopt_vulkan_output, which others contain, have no struct_size and never change.
 *
 * Memory: arrays are the caller's, before and after a call. Strides are in bytes; 0 means without gaps. Handles are
 * released once by the function for their type, which takes NULL, too; a model or device that instances still use lives
 * on until they are gone.
 *
 * Threads: models and devices may be used from several threads at once. An instance or a state is used by one thread at
 * a time, different ones by different threads at once. bodyopt_last_error() is of the calling thread.
 */
#ifndef BODYOPT_BODYOPT_H
#define BODYOPT_BODYOPT_H

#include <stddef.h>
#include <stdint.h>

#define BODYOPT_VERSION_MAJOR 0
#define BODYOPT_VERSION_MINOR 1
#define BODYOPT_VERSION_PATCH 0

#ifndef BODYOPT_API
#define BODYOPT_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The same numbers as the program's exit codes, where it has them. */
typedef enum bodyopt_result {
  BODYOPT_OK = 0,
  BODYOPT_MISMATCH =
      3,              /* things that do not belong together: a pose of another skeleton, numbers that are not finite */
  BODYOPT_FILE = 4,   /* a file cannot be read or written, or its bytes are wrong */
  BODYOPT_DEVICE = 5, /* no such device, or the device failed */
  BODYOPT_USAGE = 64, /* a wrong argument: a null pointer, a stride too small, an unknown struct_size */
  BODYOPT_INTERNAL = 70, /* a defect of the library */
  BODYOPT_MEMORY = 71    /* out of memory */
} bodyopt_result;

typedef struct bodyopt_model bodyopt_model;       /* the tables of a character: constant */
typedef struct bodyopt_device bodyopt_device;     /* an open Vulkan device */
typedef struct bodyopt_instance bodyopt_instance; /* evaluates a model; has the state of the jiggle */
typedef struct bodyopt_state bodyopt_state;       /* the jiggle of an instance at one moment */

/* Of the library that runs, as "0.1.0"; the macros are those that the program was compiled with. */
BODYOPT_API const char* bodyopt_version(void);
/* What the last call of this thread that failed has to say, in a sentence; "" before any. Lives until the next. */
BODYOPT_API const char* bodyopt_last_error(void);

typedef enum bodyopt_log_level {
  BODYOPT_LOG_ERROR = 0,   /* a call failed: what bodyopt_last_error() says */
  BODYOPT_LOG_WARNING = 1, /* a call did less than it was asked for */
  BODYOPT_LOG_INFO = 2     /* a character was loaded, a device opened */
} bodyopt_log_level;

/* `message`: a sentence in UTF-8, which lives until the function returns. `user`: as bodyopt_set_log got it. */
typedef void (*bodyopt_log)(bodyopt_log_level level, const char* message, void* user);

/* Has all that the library does in this process told to `log`; NULL: to nobody, as at first. It is called on the thread
 * of the call that it tells of, before that returns, and on several threads at once where calls are. What it throws is
 * dropped, and what it itself calls of the library is not told. Once this returns, the function that was there before
 * is neither running nor called again. BODYOPT_USAGE when it is called by `log`. */
BODYOPT_API bodyopt_result bodyopt_set_log(bodyopt_log log, void* user);

/* ---- A character ---- */

typedef struct bodyopt_load_options {
  size_t struct_size;
  const char* dynamics; /* file of diffuse and jiggle; NULL: the skin is quasi-static */
  uint32_t level;       /* of detail, in a file of several; 0 is the finest */
  /* Two texture coordinates of each vertex of this level, for bodyopt_skin.tangents; read while the model is loaded.
   * Level 0 has the vertices of the character's file, in their order; coarser ones have vertices of their own, which
   * bodyopt_get_triangles and the skin at rest tell. NULL: tangents cannot be asked for. */
  const float* texture;
  size_t texture_size;   /* bytes from `texture` on that can be read */
  size_t texture_stride; /* bytes from one vertex to the next, a multiple of 4; 0: without gaps */
  size_t texture_count;  /* vertices that they are of: as many as the model has */
  /* The bytes of the file of `dynamics`, which is NULL then; read while the model is loaded. NULL: none. */
  const void* dynamics_data;
  size_t dynamics_size; /* bytes */
  /* The file of the meshes that are attached to the skin (clothes, eyes), as `bodyopt attach` writes it, or its bytes;
   * both NULL: none. They follow level 0, BODYOPT_USAGE for another. */
  const char* attached;
  const void* attached_data;
  size_t attached_size; /* bytes */
} bodyopt_load_options;
#define BODYOPT_LOAD_OPTIONS_FIRST_SIZE 24u

/* `path`: BASIS.safetensors, UTF-8. `options`: NULL for none. BODYOPT_FILE, BODYOPT_MISMATCH (texture coordinates of
 * another number of vertices or that are not finite, too), BODYOPT_USAGE. */
BODYOPT_API bodyopt_result bodyopt_load_model(const char* path, const bodyopt_load_options* options,
                                              bodyopt_model** model);
/* The same of the bytes of that file, `size` of them, which are read while the model is loaded. They need no alignment.
 */
BODYOPT_API bodyopt_result bodyopt_load_model_from_memory(const void* data, size_t size,
                                                          const bodyopt_load_options* options, bodyopt_model** model);
BODYOPT_API void bodyopt_release_model(bodyopt_model* model);

typedef struct bodyopt_description {
  size_t struct_size;
  uint32_t vertex_count, triangle_count;
  uint32_t joint_count, control_count, strain_count;
  uint32_t has_dynamics;      /* 1: instances can jiggle */
  float frames_per_second;    /* at which they do; 0 without dynamics */
  uint32_t knows_error;       /* 1: bodyopt_skin.expected_errors can be asked for */
  uint32_t has_tangents;      /* 1: bodyopt_skin.tangents can be asked for */
  uint32_t channel_count;     /* of its modifiers */
  uint32_t attached_count;    /* meshes that are attached to its skin */
  uint32_t full_vertex_count; /* of a level of detail that carries the full skin: vertices of that; 0 of others */
  uint32_t feature_count;     /* of what its learned part reads */
} bodyopt_description;
#define BODYOPT_DESCRIPTION_FIRST_SIZE 40u

BODYOPT_API bodyopt_result bodyopt_describe(const bodyopt_model* model, bodyopt_description* description);
/* Names, in UTF-8, of joints, controls and muscle fibres ("biceps/1"); they live as long as the model. NULL where there
 * is none of this number. */
BODYOPT_API const char* bodyopt_joint_name(const bodyopt_model* model, uint32_t joint);
BODYOPT_API const char* bodyopt_control_name(const bodyopt_model* model, uint32_t control);
BODYOPT_API const char* bodyopt_strain_name(const bodyopt_model* model, uint32_t strain);
/* What bodyopt_skin.excess has, and outside_features counts: "joint elbow", "place of joint elbow" where joints slide,
 * "strain biceps/1" or "control biceps". As the names above. */
BODYOPT_API const char* bodyopt_feature_name(const bodyopt_model* model, uint32_t feature);
/* The joint that it hangs on, which has a smaller number; -1 for a root, and where there is none of this number. */
BODYOPT_API int32_t bodyopt_joint_parent(const bodyopt_model* model, uint32_t joint);
/* Three vertices of each triangle. `size`: bytes that `triangles` has room for. */
BODYOPT_API bodyopt_result bodyopt_get_triangles(const bodyopt_model* model, uint32_t* triangles, size_t size);
/* Ten numbers of each joint, as in bodyopt_poses. `size`: bytes that `joints` has room for. */
BODYOPT_API bodyopt_result bodyopt_get_bind_pose(const bodyopt_model* model, double* joints, size_t size);

typedef struct bodyopt_attached {
  size_t struct_size;
  const char* name; /* UTF-8; lives as long as the model */
  uint32_t vertex_count, triangle_count;
} bodyopt_attached;
#define BODYOPT_ATTACHED_FIRST_SIZE 24u

/* `mesh`: a number below attached_count, or BODYOPT_USAGE. */
BODYOPT_API bodyopt_result bodyopt_describe_attached(const bodyopt_model* model, uint32_t mesh,
                                                     bodyopt_attached* description);
/* As bodyopt_get_triangles, of an attached mesh. */
BODYOPT_API bodyopt_result bodyopt_get_attached_triangles(const bodyopt_model* model, uint32_t mesh,
                                                          uint32_t* triangles, size_t size);

/* What steers a modifier of the character (breath, sculpts, sag, push-out, see bodyopt_poses.shows_modifiers): how
 * strongly it is shown, or one of its controls. */
typedef struct bodyopt_channel {
  size_t struct_size;
  const char* name; /* "breathing", or "breathing.rate"; texts are UTF-8 and live as long as the model */
  const char* what; /* a line, with the unit */
  float constant;   /* what the character was approved with: its value where poses give no channels */
  float low, high;  /* values outside are clamped, which the log is told as a warning */
} bodyopt_channel;
#define BODYOPT_CHANNEL_FIRST_SIZE 40u

/* `channel`: a number below channel_count, or BODYOPT_USAGE. */
BODYOPT_API bodyopt_result bodyopt_describe_channel(const bodyopt_model* model, uint32_t channel,
                                                    bodyopt_channel* description);

/* ---- Where it runs ---- */

typedef struct bodyopt_device_description {
  size_t struct_size;
  uint32_t index;        /* bodyopt_device_options.name takes it, as text */
  char name[256];        /* UTF-8 */
  char type[16];         /* "discrete", "integrated", "virtual", "cpu" (a software device) or "other" */
  uint64_t memory_bytes; /* of its largest heap of its own */
  char problem[128];     /* why it cannot be opened; "" where it can */
} bodyopt_device_description;
#define BODYOPT_DEVICE_DESCRIPTION_FIRST_SIZE 424u

/* Writes the Vulkan devices of this machine, in the order of their indices, into `devices`, which has room for `room`
 * of them, each with the same struct_size; further ones are left out. `count`: how many there are, 0 on a machine
 * without Vulkan. With a `room` of 0 `devices` may be NULL. BODYOPT_USAGE, BODYOPT_DEVICE where Vulkan itself fails. */
BODYOPT_API bodyopt_result bodyopt_list_devices(bodyopt_device_description* devices, size_t room, size_t* count);

typedef struct bodyopt_device_options {
  size_t struct_size;
  const char* name;           /* an index or part of a name, as `bodyopt devices` lists them; NULL: the best one */
  uint32_t validation;        /* 1: with Vulkan's validation layers; whatever they say is an error */
  const char* pipeline_cache; /* folder where the driver's compiled shaders are kept, so that later processes start
                                 sooner; made where it is missing. One that cannot be read or written is no error: it is
                                 as without. NULL: nothing is kept */
} bodyopt_device_options;
#define BODYOPT_DEVICE_OPTIONS_FIRST_SIZE 24u

/* `options`: NULL for none. BODYOPT_DEVICE where there is no such device, with a list of those there are. */
BODYOPT_API bodyopt_result bodyopt_open_device(const bodyopt_device_options* options, bodyopt_device** device);
BODYOPT_API void bodyopt_release_device(bodyopt_device* device);
BODYOPT_API const char* bodyopt_device_name(const bodyopt_device* device);

/* Threads that the host lends to the CPU's kernels. */
typedef struct bodyopt_executor {
  size_t struct_size;
  /* Calls task(context, begin, end) for parts that cover 0 to count once, none with less than `grain` elements where
   * there are as many, on whatever threads; returns when all are done. The task throws nothing. */
  void (*parallel_for)(void* host, size_t count, size_t grain,
                       void (*task)(const void* context, size_t begin, size_t end), const void* context);
  void* host; /* given to parallel_for */
} bodyopt_executor;
#define BODYOPT_EXECUTOR_FIRST_SIZE 24u

typedef struct bodyopt_instance_options {
  size_t struct_size;
  const bodyopt_device* device;     /* NULL: the CPU */
  const bodyopt_executor* executor; /* of the CPU; NULL: oneTBB's threads */
  uint32_t jiggles;                 /* 1: bodyopt_jiggle can be called; needs a model with dynamics */
  uint32_t iterations;              /* has no effect: of a mode of the jiggle that there was; leave 0 */
  uint32_t check;                   /* 1: every stage on the device beside the same on the CPU; the first difference is
                                       an error, BODYOPT_DEVICE, that names stage, frame of the call, vertex and both
                                       values */
  double gravity_change[3];         /* against the gravity that the shapes have in them, m/s^2, world; each -1000 to
                                       1000 */
  uint32_t recorded_frames;         /* most frames of a bodyopt_record, for which there is memory then; 0: 1 */
} bodyopt_instance_options;
#define BODYOPT_INSTANCE_OPTIONS_FIRST_SIZE 64u

/* Instances of one model that are made on one device, without others between, share its tables there. `options`: NULL
 * for none. BODYOPT_DEVICE, BODYOPT_USAGE. */
BODYOPT_API bodyopt_result bodyopt_create_instance(const bodyopt_model* model, const bodyopt_instance_options* options,
                                                   bodyopt_instance** instance);
BODYOPT_API void bodyopt_release_instance(bodyopt_instance* instance);
/* How much is shown of what was learned, and of the jiggle; 1 and 1 at first. Each -1000 to 1000, or
 * BODYOPT_USAGE. */
BODYOPT_API bodyopt_result bodyopt_set_weights(bodyopt_instance* instance, float correction, float jiggle);

/* ---- Frames ---- */

typedef struct bodyopt_poses {
  size_t struct_size;
  uint32_t frame_count;
  uint32_t joint_count;   /* that of the model */
  uint32_t control_count; /* that of the model; 0: all controls are 0 */
  /* Of each frame and joint ten numbers: translation x y z, rotation x y z w, scale x y z, relative to the parent. */
  const double* joints;
  size_t joint_stride, joint_frame_stride;
  const float* controls; /* of each frame one number a control */
  size_t control_frame_stride;
  const int32_t* frame_numbers; /* of each frame; for bodyopt_jiggle alone */
  /* 1: the skin with the character's modifiers, as `bodyopt eval` shows it; the frames are consecutive. 0: without. A
   * model whose modifiers are of a type that this version does not know is a BODYOPT_MISMATCH. */
  uint32_t shows_modifiers;
  /* 0: the first frame is a clip's first, where a breath begins. 1: it follows the last frame that this instance has
   * shown with modifiers; where there is none it is a clip's first. A bodyopt_state knows nothing of it. */
  uint32_t goes_on;
  double frames_per_second; /* of frames with modifiers: 0.001 to 1000000 */
  const float* channels;    /* of each frame one number a channel; NULL: the constants of bodyopt_channel */
  uint32_t channel_count;   /* that of the model, where there are channels */
  size_t channel_frame_stride;
  /* In place of `joints`, which is NULL then. Of each frame and joint twelve numbers: its skinning matrix, rest space
   * to world, three rows of four, of which the last is the translation. Single precision: 0.06 mm at a kilometre from
   * the origin. BODYOPT_MISMATCH where a joint is sheared against its parent, or scaled by 0. */
  const float* skinning;
  size_t skinning_stride, skinning_frame_stride;
} bodyopt_poses;
#define BODYOPT_POSES_FIRST_SIZE 72u

/* An output, and the memory that it may write: at data + frame * frame_stride + element * element_stride. */
typedef struct bodyopt_floats {
  float* data;                         /* NULL: not wanted */
  size_t size;                         /* bytes from `data` on that are the caller's */
  size_t element_stride, frame_stride; /* multiples of 4 */
} bodyopt_floats;

typedef struct bodyopt_skin {
  size_t struct_size;
  bodyopt_floats positions; /* of each vertex three numbers, metres */
  bodyopt_floats normals;   /* of each vertex three numbers; zero where all triangles around it are degenerate */
  bodyopt_floats strains;   /* of each fibre one number: its length over that at rest, minus 1 */
  bodyopt_floats outside;   /* of each frame one number: how far the worst of what the learned part reads lies outside
                               its trained range, in standard deviations of training; 0: the pose is covered */
  bodyopt_floats fades;     /* of each frame one number: how much is left of what was learned, 0 to 1 */
  bodyopt_floats expected_errors; /* of each frame one number: how far off the skin is expected to be, by what training
                                     left and how far the pose is from what it saw; RMS over the skin, metres. Only of
                                     a model that knows_error, BODYOPT_MISMATCH of others */
  /* Of each vertex four numbers, by the convention of MikkTSpace with the texture coordinates as they were given: the
   * tangent, to where the first of them grows, a unit across the normal (zero where no triangle has an area on the
   * texture), and the sign s of the bitangent, s times normal x tangent, to where the second grows. Only of a model
   * that has_tangents, BODYOPT_USAGE of others. */
  bodyopt_floats tangents;
  /* Of each vertex one number: expected_errors by what the regions share in it, metres; 0 where nothing was learned.
   * Only of a model that knows_error, BODYOPT_MISMATCH of others. */
  bodyopt_floats vertex_errors;
  bodyopt_floats outside_features; /* of each frame one number: the feature that lies outside, by which
                                      bodyopt_feature_name names it; -1 where `outside` is 0 */
  const bodyopt_floats* attached;  /* an output of each attached mesh: of each of its vertices three numbers */
  uint32_t attached_count;         /* that of the model; 0: none is wanted */
  bodyopt_floats full_positions;   /* of each vertex of the full skin three numbers; of a model with a
                                      full_vertex_count, BODYOPT_USAGE of others */
  bodyopt_floats excess;           /* of each frame one number a feature: `outside` of each, named by
                                      bodyopt_feature_name */
} bodyopt_skin;
#define BODYOPT_SKIN_FIRST_SIZE 168u

/* The quasi-static skin. Where no output is wanted, modifiers go on past the frames, without the time of a skin.
 * BODYOPT_MISMATCH where a pose does not fit the model, is not finite or has a rotation of
 * length 0, BODYOPT_USAGE, BODYOPT_DEVICE. */
BODYOPT_API bodyopt_result bodyopt_evaluate(bodyopt_instance* instance, const bodyopt_poses* poses,
                                            const bodyopt_skin* skin);
/* The skin with jiggle, frames in the order of the shot; it goes on from the frames of earlier calls. Where it fails,
 * the state is that of before. */
BODYOPT_API bodyopt_result bodyopt_jiggle(bodyopt_instance* instance, const bodyopt_poses* poses,
                                          const bodyopt_skin* skin);

/* What one instance does among others. */
typedef struct bodyopt_call {
  size_t struct_size;
  bodyopt_instance* instance; /* each in one call only */
  const bodyopt_poses* poses;
  const bodyopt_skin* skin;
  uint32_t jiggles;      /* 1: as bodyopt_jiggle; 0: as bodyopt_evaluate */
  bodyopt_result result; /* written: of this call */
} bodyopt_call;
#define BODYOPT_CALL_FIRST_SIZE 40u

/* Many instances at once, of one model or of several: what a device has to do for all of them goes there in one
 * submission and is waited for once. The same bits as one after the other. One that fails takes none of the others with
 * it, unless their device is lost; what is given back is BODYOPT_OK where all went well, or the result of the first
 * that did not, and bodyopt_last_error() names those that did not by their number, "call 3: ...". `calls`: `count` of
 * them, each with the same struct_size. On one thread, as a call of each of the instances. */
BODYOPT_API bodyopt_result bodyopt_evaluate_together(bodyopt_call* calls, size_t count);

/* ---- The state of the jiggle ---- */

BODYOPT_API bodyopt_result bodyopt_get_state(const bodyopt_instance* instance, bodyopt_state** state);
/* NULL: nothing is known of frames before, as at first. */
BODYOPT_API bodyopt_result bodyopt_set_state(bodyopt_instance* instance, const bodyopt_state* state);
BODYOPT_API void bodyopt_release_state(bodyopt_state* state);
/* A state as a file, which `bodyopt eval --state-in` reads, too. `instance` says of which dynamics: a state of others
 * is a BODYOPT_MISMATCH, saved or loaded. */
BODYOPT_API bodyopt_result bodyopt_save_state(const bodyopt_instance* instance, const bodyopt_state* state,
                                              const char* path);
BODYOPT_API bodyopt_result bodyopt_load_state(const bodyopt_instance* instance, const char* path,
                                              bodyopt_state** state);

#ifdef __cplusplus
}
#endif
#endif
