namespace pcl_semantic {}
