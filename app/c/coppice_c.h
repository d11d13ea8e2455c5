#ifndef COPPICE_C_H
#define COPPICE_C_H

/**
 * @file
 * The C interface of Coppice: libcoppice_c.so, for programs in C and in languages that call C.
 *
 * A task runs the commands of the program, with the same words as on the command line; objects in memory take
 * the place of files: inputs and outputs with a name that begins with "memory:" are objects of the task.
 *
 *     coppice_task* task = coppice_task_create();
 *     const char* words[] = {"mesh", "oak.swc", "-o", "memory:oak.glb", "--levels", "2"};
 *     if (coppice_task_run(task, 6, words) != COPPICE_OK) puts(coppice_task_message(task));
 *     coppice_object* surface = coppice_task_take(task, "memory:oak.glb");
 *     coppice_surface_arrays arrays;
 *     coppice_surface_get(surface, &arrays);
 *
 * All texts are UTF-8 and end with a null character. There is no global state: threads can work at the same
 * time, each with its own task. Objects are immutable, and can be used by several threads and tasks.
 */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
/** Marks the functions that the library exports. */
#define COPPICE_API __attribute__((visibility("default")))
#else
#define COPPICE_API
#endif

/* NOLINTBEGIN(readability-identifier-naming): names of C. */

/** Result of a call: the exit codes of the program. */
typedef enum coppice_status {
    COPPICE_OK = 0,           /**< done */
    COPPICE_CHECK_FAILED = 1, /**< done, and a check found a defect */
    COPPICE_WRONG_USAGE = 2,  /**< an option or an argument is invalid */
    COPPICE_BAD_INPUT = 3,    /**< the data is invalid */
    COPPICE_FILE_TROUBLE = 4, /**< a file cannot be read or written */
    COPPICE_INTERRUPTED = 130 /**< the task was cancelled */
} coppice_status;

/** Kind of an object. */
typedef enum coppice_kind {
    COPPICE_SKELETON = 0, /**< nodes with radii */
    COPPICE_SURFACE = 1,  /**< vertices and faces */
    COPPICE_POINTS = 2,   /**< points with attributes */
    COPPICE_BYTES = 3     /**< the text of a scene, or an image as PNG */
} coppice_kind;

/** Runs commands, one after the other. */
typedef struct coppice_task coppice_task;
/** An immutable skeleton, surface, cloud of points or text. */
typedef struct coppice_object coppice_object;

/** Returns the version, such as "0.1.0". */
COPPICE_API const char* coppice_version(void);

/** Creates a task. Returns null if there is not enough memory. */
COPPICE_API coppice_task* coppice_task_create(void);
/** Deletes a task that does not run; ignores null. The objects that were taken from it remain valid. */
COPPICE_API void coppice_task_free(coppice_task* task);

/**
 * Is called during a run, in the thread that runs the task: the name of the stage, its progress from 0 to 1,
 * and the argument of coppice_task_set_progress(). Any other result than 0 cancels the run.
 */
typedef int (*coppice_progress)(void* user, const char* stage, double fraction);
/** Sets the function that shows progress; null: none. */
COPPICE_API void coppice_task_set_progress(coppice_task* task, coppice_progress progress, void* user);

/**
 * Requests that the current or next run of the task ends as soon as possible, with COPPICE_INTERRUPTED. May
 * be called from any thread.
 */
COPPICE_API void coppice_task_cancel(coppice_task* task);

/**
 * Runs a command: the words are its name, its files and its options, as on the command line after "coppice".
 * All commands are available except shell and studio; the command "schema" prints all of them with their
 * options, types, units, ranges, defaults and helps as JSON. Returns COPPICE_WRONG_USAGE if the task runs in
 * another thread.
 */
COPPICE_API coppice_status coppice_task_run(coppice_task* task, size_t count, const char* const* words);

/**
 * Returns the sentence that explains why the last call failed, or the messages of the last run, one per line.
 * Valid until the next call with this task, like the results of the two following functions.
 */
COPPICE_API const char* coppice_task_message(const coppice_task* task);
/** Returns the text that the last run printed, such as a table; with --json it is JSON. */
COPPICE_API const char* coppice_task_output(const coppice_task* task);
/** Returns the report of the last run as JSON: stages with seconds, counts, repairs and warnings. */
COPPICE_API const char* coppice_task_report(const coppice_task* task);

/**
 * Stores an object in a task for its next runs. The name is "memory:" and a file name. The task shares the
 * object, which can be deleted.
 */
COPPICE_API coppice_status coppice_task_put(coppice_task* task, const char* name,
                                            const coppice_object* object);
/**
 * Returns the object of a name, such as that of an output of the last run; the caller deletes it. Returns
 * null if there is none. The extension of an output selects its kind: "memory:oak.json" is a skeleton,
 * "memory:oak.glb" a surface, "memory:oak.las" points, "memory:oak.png" an image.
 */
COPPICE_API coppice_object* coppice_task_take(coppice_task* task, const char* name);

/** Deletes an object and makes its arrays invalid, unless a task shares it; ignores null. */
COPPICE_API void coppice_object_free(coppice_object* object);
/** Returns the kind of an object. */
COPPICE_API coppice_kind coppice_object_kind(const coppice_object* object);

/** The arrays of a skeleton, which belong to the object. Parents precede their children. */
typedef struct coppice_skeleton_arrays {
    size_t count;           /**< number of nodes */
    const float* positions; /**< [m] three coordinates of each node, relative to the origin, Z up */
    const float* radii;     /**< [m] > 0 */
    const int32_t* parents; /**< index of the parent of each node; -1: none */
    double origin[3];       /**< [m] */
    const char* units;      /**< unit of the lengths: "m", "mm", "um" and others */
} coppice_skeleton_arrays;
/** Gets the arrays of a skeleton. Returns COPPICE_WRONG_USAGE for other objects, as do the next functions. */
COPPICE_API coppice_status coppice_skeleton_get(const coppice_object* skeleton,
                                                coppice_skeleton_arrays* arrays);

/** The arrays of a surface, which belong to the object. Faces are counter-clockwise seen from outside. */
typedef struct coppice_surface_arrays {
    size_t vertex_count;            /**< number of vertices */
    const float* positions;         /**< [m] three coordinates of each vertex, relative to the origin, Z up */
    size_t face_count;              /**< number of faces */
    size_t face_size;               /**< number of corners of each face; 0 if faces differ */
    size_t corner_count;            /**< number of corners of all faces */
    const uint32_t* corners;        /**< vertices of the corners, face by face */
    const uint32_t* first;          /**< first corner of each face, and the end; null unless face_size is 0 */
    const float* texture;           /**< two texture coordinates of each corner, or null */
    const uint32_t* material_slots; /**< of each face: 0 bark, 1 twig, 2 cut; or null */
    double origin[3];               /**< [m] */
} coppice_surface_arrays;
/** Gets the arrays of a surface. */
COPPICE_API coppice_status coppice_surface_get(const coppice_object* surface, coppice_surface_arrays* arrays);
/** Computes the unit normals of the vertices of a surface, weighted by area, into three numbers for each. */
COPPICE_API coppice_status coppice_surface_normals(const coppice_object* surface, float* normals);

/** The placed copies of meshes in addition to a surface, such as leaves; the arrays belong to the surface. */
typedef struct coppice_instances_arrays {
    size_t count;               /**< number of copies; 0 without leaves */
    const uint32_t* prototypes; /**< mesh of each copy */
    const float* positions; /**< [m] three coordinates of the point of attachment, relative to the origin */
    const float* rotations; /**< unit quaternions x, y, z, w from the frame of the mesh to that of the tree */
    const float* scales;    /**< > 0 */
    const uint8_t* colors;  /**< sRGB of each copy, multiplied with the colour of the mesh */
    double origin[3];       /**< [m] */
    size_t prototype_count; /**< number of meshes, see coppice_prototype_get() */
} coppice_instances_arrays;
/** Gets the placed copies of a surface, as made by tree and leaves. */
COPPICE_API coppice_status coppice_instances_get(const coppice_object* surface,
                                                 coppice_instances_arrays* arrays);

/** A mesh that is placed many times. Its origin is the point of attachment, its length extends along +y. */
typedef struct coppice_prototype {
    const char* name;     /**< such as "leaf_1"; belongs to the surface */
    coppice_object* mesh; /**< triangles with texture coordinates; the caller deletes it */
    float color[3];       /**< linear colour, multiplied with that of the image */
    const char* image;    /**< the image as PNG, which belongs to the surface; null if there is none */
    size_t image_size;    /**< number of bytes of the image */
} coppice_prototype;
/** Gets a mesh of the copies. Returns COPPICE_WRONG_USAGE if the index is not less than their number. */
COPPICE_API coppice_status coppice_prototype_get(const coppice_object* surface, size_t index,
                                                 coppice_prototype* prototype);

/** The arrays of points, which belong to the object. */
typedef struct coppice_points_arrays {
    size_t count;             /**< number of points */
    const float* positions;   /**< [m] three coordinates of each point, relative to the origin, Z up */
    double origin[3];         /**< [m] */
    const float* intensities; /**< intensities of the returns, or null */
    const uint8_t* classes;   /**< classes of LAS, or null */
    const uint8_t* colors;    /**< red, green and blue of each point, or null */
    const uint32_t* tree_ids; /**< tree of each point, 0 = none; or null */
} coppice_points_arrays;
/** Gets the arrays of points. */
COPPICE_API coppice_status coppice_points_get(const coppice_object* points, coppice_points_arrays* arrays);

/** Gets the bytes of a text or an image, which belong to the object. */
COPPICE_API coppice_status coppice_bytes_get(const coppice_object* object, const char** bytes, size_t* count);

/** Returns the number of attributes of the nodes of a skeleton, or of the vertices of a surface. */
COPPICE_API size_t coppice_attribute_count(const coppice_object* object);
/** Gets the name and the values of an attribute, one for each node or vertex; they belong to the object. */
COPPICE_API coppice_status coppice_attribute_get(const coppice_object* object, size_t index,
                                                 const char** name, const float** values);

/** Arrays for coppice_skeleton_create(), which copies and repairs them. */
typedef struct coppice_nodes {
    size_t count;            /**< number of nodes */
    const double* positions; /**< [m] three coordinates of each node, Z up */
    const double* radii;     /**< [m]; not positive or NaN: unknown, see the documentation of repairs */
    const int64_t* ids;      /**< unique numbers; null: 0, 1, 2, ... */
    const int64_t* parents;  /**< id of the parent of each node; negative, or no id of a node: none */
} coppice_nodes;
/** Creates a skeleton of nodes in any order, and repairs it as files are; the report of the task counts this.
 */
COPPICE_API coppice_status coppice_skeleton_create(coppice_task* task, const coppice_nodes* nodes,
                                                   coppice_object** skeleton);

/** Arrays for coppice_surface_create(), which copies them. */
typedef struct coppice_faces {
    size_t vertex_count;     /**< number of vertices */
    const double* positions; /**< [m] three coordinates of each vertex, Z up */
    size_t face_count;       /**< number of faces */
    size_t face_size;        /**< number of corners of each face, at least 3 */
    const int64_t* corners;  /**< vertices of the corners, counter-clockwise seen from outside */
} coppice_faces;
/** Creates a surface. */
COPPICE_API coppice_status coppice_surface_create(coppice_task* task, const coppice_faces* faces,
                                                  coppice_object** surface);

/** Creates points from three coordinates [m] of each, Z up, and copies them. */
COPPICE_API coppice_status coppice_points_create(coppice_task* task, size_t count, const double* positions,
                                                 coppice_object** points);
/** Creates a text, such as a scene, and copies it. */
COPPICE_API coppice_status coppice_bytes_create(coppice_task* task, const char* bytes, size_t count,
                                                coppice_object** object);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
