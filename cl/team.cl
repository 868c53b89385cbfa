// A team shares the work of a row. It is one work-item or, with TEAM_IS_GROUP, the GROUP items of a
// work-group: item ITEM of ITEMS takes every ITEMS-th element or vector, and what the items found is combined
// in local memory, in an order that depends on nothing but GROUP.
#ifdef TEAM_IS_GROUP
#define TEAM_SIZE __attribute__((reqd_work_group_size(GROUP, 1, 1)))
#define TEAM get_group_id(0)
#define ITEM ((uint)get_local_id(0))
#define ITEMS GROUP
#define TEAM_MEMORY(name) local real name[GROUP]
// What the items wrote before can be read by all.
#define team_barrier() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)

#define DEFINE_TEAM_FUNCTION(name, combine)                                       \
  static inline real name(real value, local real* memory) {                       \
    memory[ITEM] = value;                                                         \
    for (uint step = GROUP / 2; step > 0; step /= 2) {                            \
      barrier(CLK_LOCAL_MEM_FENCE);                                               \
      if (ITEM < step) memory[ITEM] = combine(memory[ITEM], memory[ITEM + step]); \
    }                                                                             \
    barrier(CLK_LOCAL_MEM_FENCE);                                                 \
    const real result = memory[0];                                                \
    barrier(CLK_LOCAL_MEM_FENCE); /* before it is used again */                   \
    return result;                                                                \
  }
#define ADD(a, b) ((a) + (b))
DEFINE_TEAM_FUNCTION(team_sum, ADD)
DEFINE_TEAM_FUNCTION(team_max, fmax)
#else
#define TEAM_SIZE
#define TEAM get_global_id(0)
#define ITEM 0
#define ITEMS 1
#define TEAM_MEMORY(name)
#define team_barrier()
#define team_sum(value, memory) (value)
#define team_max(value, memory) (value)
#endif
